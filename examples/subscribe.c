/* Print t, q and tip of every block that limbd (limb/frames) or limbplay serve (limb/play) sends.
 *
 *   cc -o subscribe subscribe.c $(pkg-config --cflags --libs libzmq msgpack)   # msgpack-c where there is no msgpack
 *   ./subscribe tcp://127.0.0.1:5770
 */
#include <msgpack.h>
#include <stdio.h>
#include <string.h>
#include <zmq.h>

static int is(msgpack_object key, const char *name)
{
    return key.type == MSGPACK_OBJECT_STR && key.via.str.size == strlen(name)
        && !memcmp(key.via.str.ptr, name, key.via.str.size);
}

static const msgpack_object *field(const msgpack_object *map, const char *name)
{
    if (map && map->type == MSGPACK_OBJECT_MAP)
        for (uint32_t i = 0; i < map->via.map.size; i++)
            if (is(map->via.map.ptr[i].key, name))
                return &map->via.map.ptr[i].val;
    return NULL;
}

/* The last row of an array {"dtype": "<f8", "shape": [n, columns], "data": bytes}; returns its columns, or -1. */
static int last_row(const msgpack_object *array, double *row, uint64_t room)
{
    const msgpack_object *dtype = field(array, "dtype"), *shape = field(array, "shape"), *data = field(array, "data");
    if (!dtype || !is(*dtype, "<f8") || !shape || shape->type != MSGPACK_OBJECT_ARRAY || shape->via.array.size != 2
        || !data || data->type != MSGPACK_OBJECT_BIN)
        return -1;
    uint64_t n = shape->via.array.ptr[0].via.u64, columns = shape->via.array.ptr[1].via.u64;
    if (n < 1 || columns > room || data->via.bin.size != n * columns * sizeof(double))
        return -1;
    /* little-endian doubles: on a big-endian machine their bytes would have to be turned round */
    memcpy(row, data->via.bin.ptr + (n - 1) * columns * sizeof(double), columns * sizeof(double));
    return (int)columns;
}

static void print_block(const char *bytes, size_t size)
{
    double q[64], tip[3];
    msgpack_unpacked block;
    msgpack_unpacked_init(&block);
    if (msgpack_unpack_next(&block, bytes, size, NULL) == MSGPACK_UNPACK_SUCCESS) {
        const msgpack_object *t0_ns = field(&block.data, "t0_ns"), *dt_s = field(&block.data, "dt_s");
        const msgpack_object *n = field(&block.data, "n"), *v = field(&block.data, "v");
        int n_joint = last_row(field(&block.data, "q"), q, 64);
        if (v && v->via.u64 == 1 && t0_ns && dt_s && n && n_joint > 0 && last_row(field(&block.data, "tip"), tip, 3) == 3) {
            printf("t %.6f q", 1e-9 * (double)t0_ns->via.u64 + (double)(n->via.u64 - 1) * dt_s->via.f64);
            for (int j = 0; j < n_joint; j++)
                printf(" %.9f", q[j]);
            printf(" tip %.9f %.9f %.9f\n", tip[0], tip[1], tip[2]);
            fflush(stdout);
        }
    }
    msgpack_unpacked_destroy(&block);
}

int main(int argc, char **argv)
{
    void *context = zmq_ctx_new(), *socket = zmq_socket(context, ZMQ_SUB);
    if (zmq_connect(socket, argc > 1 ? argv[1] : "tcp://127.0.0.1:5770")) {
        fprintf(stderr, "%s\n", zmq_strerror(zmq_errno()));
        return 3;
    }
    zmq_setsockopt(socket, ZMQ_SUBSCRIBE, "limb/frames", 11);
    zmq_setsockopt(socket, ZMQ_SUBSCRIBE, "limb/play", 9);
    for (;;) {
        zmq_msg_t part; /* two parts: the topic, then the map */
        zmq_msg_init(&part);
        if (zmq_msg_recv(&part, socket, 0) < 0)
            return 3;
        int more = zmq_msg_more(&part);
        zmq_msg_close(&part);
        if (!more)
            continue;
        zmq_msg_init(&part);
        if (zmq_msg_recv(&part, socket, 0) < 0)
            return 3;
        print_block(zmq_msg_data(&part), zmq_msg_size(&part));
        zmq_msg_close(&part);
    }
}

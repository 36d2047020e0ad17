// Print t, q and tip of every block that limbd (limb/frames) or limbplay serve (limb/play) sends.
//
//   npm install && node subscribe.js tcp://127.0.0.1:5770
const zmq = require("zeromq");
const { decode } = require("@msgpack/msgpack");

// The last row of an array {"dtype": "<f8", "shape": [n, columns], "data": bytes}.
function lastRow({ dtype, shape: [n, columns], data }) {
  if (dtype !== "<f8") throw new Error(`dtype is ${dtype}, expected <f8`);
  const bytes = new DataView(data.buffer, data.byteOffset, data.byteLength);
  return Array.from({ length: columns }, (_, k) => bytes.getFloat64(8 * ((n - 1) * columns + k), true));
}

async function main() {
  const socket = new zmq.Subscriber();
  socket.connect(process.argv[2] ?? "tcp://127.0.0.1:5770");
  socket.subscribe("limb/frames", "limb/play");
  for await (const [, payload] of socket) {
    const block = decode(payload, { useBigInt64: true }); // times in ns are beyond what a double holds
    const n = Number(block.n);
    const t = Number(block.t0_ns / 1000n) / 1e6 + (n - 1) * block.dt_s;
    const [q, tip] = [block.q, block.tip].map((array) => lastRow({ ...array, shape: array.shape.map(Number) }));
    const said = (row) => row.map((value) => value.toFixed(9)).join(" ");
    console.log(`t ${t.toFixed(6)} q ${said(q)} tip ${said(tip)}`);
  }
}

main();

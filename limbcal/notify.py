"""What a service tells systemd of itself, by the protocol of ``sd_notify(3)``."""

import os
import socket

_VARIABLE = "NOTIFY_SOCKET"
#: How long a service manager that reads nothing is waited for [s]; below any watchdog's time.
_PATIENCE_S = 1.0


def notify(**fields: object) -> bool:
    """Send a state, such as ``notify(READY=1, STATUS="streaming")``; return whether anybody listens.

    A service manager that is gone, or reads nothing, is no reason to stop working.
    """
    address = os.environ.get(_VARIABLE, "")
    if not address:
        return False
    if address.startswith("@"):
        address = "\0" + address[1:]
    message = "\n".join(f"{name}={_one_line(value)}" for name, value in fields.items())
    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC) as sender:
            sender.settimeout(_PATIENCE_S)
            sender.connect(address)
            sender.send(message.encode())
    except OSError:
        return False
    return True


def _one_line(value: object) -> str:
    return " ".join(str(value).split())

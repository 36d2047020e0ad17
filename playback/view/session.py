"""One showing of the page: what it follows is started or found, and all of it is ended again."""

import argparse
import webbrowser
from collections.abc import Callable
from contextlib import ExitStack, closing

import numpy as np
import zmq

from arm.arm_file import load_arm, parse_arm
from arm.model import Arm
from limbcal.command import say_notes
from limbcal.errors import ConfigError, DeviceError
from playback.measured_markers import MeasuredMarkers, read_measured_markers
from playback.touch.process import TouchProcess
from playback.view.feed import Feed
from playback.view.handle import Handle
from playback.view.page import Page
from playback.view.playback_process import PlaybackProcess
from playback.view.remote import Remote
from playback.view.server import on_loop, web_server
from playback.view.visitors import Visitors
from protocol.curve import load_client_key

#: How long a playback that runs already may take to answer [s].
PATIENCE_S = 5.0


def run(arguments: argparse.Namespace, announce: Callable[[dict[str, object]], None]) -> None:
    """Show the page until interrupted; where it is, is announced as soon as it can be opened.

    Raises
    ------
    LimbcalError
        If what is to be shown cannot be, or ends.
    """
    visitors = Visitors(arguments.host)
    with ExitStack() as stack:
        context = stack.enter_context(zmq.Context())
        key = None if arguments.key is None else load_client_key(arguments.key)
        touch, process, endpoint, control = None, None, arguments.connect, arguments.control
        if arguments.touch:
            touch = stack.enter_context(_touched(arguments))
            endpoint = touch.endpoint
        elif endpoint is None:
            process = stack.enter_context(PlaybackProcess(context, arguments.playback))
            endpoint, control, key = process.endpoint, process.control, None
        feed = stack.enter_context(closing(Feed(context, endpoint, key)))
        remote = None
        if control is not None:
            remote = stack.enter_context(closing(Remote(context, control, key)))
        arm, twin = _arms(arguments.arm, remote)
        server = stack.enter_context(web_server(visitors, arguments.port, "limbplay"))
        handle = None
        if (running := touch) is not None:
            handle = stack.enter_context(closing(on_loop(server, lambda: Handle(server, context, arm, running))))
        markers = _markers(arguments, arm)
        page = on_loop(server, lambda: Page(server, feed, remote, arm, twin, handle, markers))
        url = visitors.url(server.get_port())
        announce({"url": url, "endpoint": endpoint, "control": control, "arm": arm.name})
        if arguments.open:
            webbrowser.open(url)
        page.run(lambda: process is not None and not process.alive())
        raise DeviceError("the playback's process has ended")


def _markers(arguments: argparse.Namespace, arm: Arm) -> dict[int, MeasuredMarkers] | None:
    """Return the markers that were measured, by trial, if they are to be shown; what is odd of them is said."""
    if not arguments.markers:
        return None
    given = arguments.playback
    markers, notes = read_measured_markers(given.source, arguments.markers, arm, given.columns)
    say_notes(notes)
    return markers


def _touched(arguments: argparse.Namespace) -> TouchProcess:
    """Return the arm that is to be touched, in a process to be started."""
    q0 = None if arguments.q0 is None else np.array(arguments.q0)
    return TouchProcess(load_arm(arguments.arm), q0)


def _arms(given: str | None, remote: Remote | None) -> tuple[Arm, Arm | None]:
    """Return the arm and the twin that are to be shown."""
    if remote is None:
        if given is None:
            raise ConfigError("--arm is missing: a stream without control does not say which arm it moves")
        return load_arm(given), None
    if not remote.answered.wait(PATIENCE_S):
        raise DeviceError(
            f"control endpoint {remote.endpoint}: no answer within {PATIENCE_S:g} s, expected a `limbplay serve`"
        )
    if remote.arms is None:
        raise ConfigError(
            f"control endpoint {remote.endpoint}: it does not say which arm it moves: {remote.refusal}"
        )
    arm, twin = remote.arms
    shown = parse_arm(arm, f"the arm of {remote.endpoint}")
    return shown, None if twin is None else parse_arm(twin, f"the twin of {remote.endpoint}")

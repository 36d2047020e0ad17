"""Commands that do what a test says."""

from limbcal.arguments import Parser, common_options


def command(action):
    """Return a parser of one command that does what ``action`` does."""
    parser = Parser(prog="limbtest", parents=[common_options()])
    parser.add_argument("--size", type=int, default=1)
    parser.set_defaults(action=action)
    return parser


def raising(error):
    def action(_):
        raise error

    return action

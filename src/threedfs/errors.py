"""The one exception that a user is meant to see."""

from __future__ import annotations


class UserError(Exception):
    """A fault in what the user gave, told in one sentence.

    The sentence says what was expected, what came, where, and what to do. Stages and topics raise it;
    the outermost layer prints it without a traceback and exits with a status that is not 0.
    """

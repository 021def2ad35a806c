"""How many threads linear algebra takes."""

import functools
from contextlib import AbstractContextManager
from typing import Any

from threadpoolctl import ThreadpoolController


@functools.cache
def _controller() -> ThreadpoolController:
    return ThreadpoolController()


def one_thread() -> AbstractContextManager[Any]:
    """For a while, one thread for BLAS and LAPACK.

    On many small matrices more threads wait for one another; on a busy machine they make a solve
    take ten times as long. Libraries that are loaded later are not seen.
    """
    return _controller().limit(limits=1, user_api="blas")

"""Connection to a scheduler of Dask, or to workers started on this machine."""

import logging
import multiprocessing
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeAlias

from fedic._internal.optional import optional_module
from fedic.errors import FedicError, OptionError

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["Cluster", "check_cluster", "connected", "distributed_module"]

Cluster: TypeAlias = "str | Client"
"""``"local:4"``, the address of a scheduler such as ``"tcp://host:8786"``, or a client."""

_LOCAL = re.compile(r"local:([1-9]\d{0,3})")
_ADDRESS = re.compile(r"[a-z]+://\S+")
_CONNECT_SECONDS = 30.0
"""Time in which a scheduler must answer."""
_GUARD = (
    "local workers run the script again while they start; put what the script does into a function, and call it under "
    "'if __name__ == \"__main__\":' at its end."
)


def distributed_module() -> Any:
    """Import Dask's package ``distributed``."""
    return optional_module("distributed", "dask", "measuring on Dask workers")


def check_cluster(cluster: Cluster) -> None:
    """Check, before any work, what tells where frames are measured.

    Parameters
    ----------
    cluster : str or distributed.Client
        The workers.

    Raises
    ------
    OptionError
        If it is something else.
    FedicError
        If Dask is not installed, or a script that starts local workers has no guard.
    """
    distributed = distributed_module()
    if isinstance(cluster, str) and _LOCAL.fullmatch(cluster):
        # A process that multiprocessing has spawned, and that still runs the script up to its guard.
        if getattr(multiprocessing.current_process(), "_inheriting", False):
            raise FedicError(_GUARD)
        return
    if isinstance(cluster, str) and _ADDRESS.fullmatch(cluster):
        return
    if isinstance(cluster, distributed.Client) and not cluster.asynchronous:
        return
    given = repr(cluster) if isinstance(cluster, str) else f"a {type(cluster).__name__}"
    raise OptionError(
        f"cluster is {given}; give 'local:4' for four processes on this machine, the address of a scheduler such as "
        "'tcp://host:8786', or a distributed.Client that is not asynchronous",
        "cluster",
    )


@contextmanager
def connected(cluster: Cluster) -> Iterator[Any]:
    """Provide a client; one that was made here is closed at the end, with its workers.

    Parameters
    ----------
    cluster : str or distributed.Client
        Accepted by `check_cluster`.

    Yields
    ------
    distributed.Client
        The client.

    Raises
    ------
    FedicError
        If the scheduler does not answer, or the workers cannot be started.
    """
    distributed = distributed_module()
    if not isinstance(cluster, str):
        yield cluster
        return
    local = _LOCAL.fullmatch(cluster)
    if local is None:
        with _client(distributed, cluster, cluster) as client:
            yield client
        return
    with _local_cluster(distributed, int(local[1])) as workers, _client(distributed, workers, cluster) as client:
        yield client


@contextmanager
def _local_cluster(distributed: Any, count: int) -> Iterator[Any]:
    cores = optional_module("dask.system", "dask", "measuring on Dask workers").CPU_COUNT
    try:
        cluster = distributed.LocalCluster(
            n_workers=count,
            threads_per_worker=max(1, cores // count),
            processes=True,
            dashboard_address="127.0.0.1:0",
            # Dask would stop a worker for ever whose prepared reference image takes most of its share.
            memory_limit=0,
            silence_logs=logging.ERROR,
            preload=["fedic.campaign.cluster.worker"],
        )
    except (RuntimeError, OSError) as error:
        raise FedicError(f"local:{count}: the workers cannot be started ({error}). In a script, {_GUARD}") from error
    try:
        yield cluster
    finally:
        cluster.close()


@contextmanager
def _client(distributed: Any, address: Any, name: str) -> Iterator[Any]:
    try:
        client = distributed.Client(address, timeout=_CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError, distributed.TimeoutError) as error:
        raise FedicError(
            f"{name}: no scheduler of Dask answers there ({error}); check the address, and that dask scheduler runs."
        ) from error
    try:
        yield client
    finally:
        client.close()

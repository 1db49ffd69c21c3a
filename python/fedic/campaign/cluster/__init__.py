"""Frames measured on Dask workers; needs the extra ``fedic[dask]``."""

from fedic.campaign.cluster.connection import Cluster, check_cluster
from fedic.campaign.cluster.executor import cluster_executor

__all__ = ["Cluster", "check_cluster", "cluster_executor"]

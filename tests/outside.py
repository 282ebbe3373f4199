"""What a command started by a person finds: nothing of the MPI of the process that tests."""

import os

LEFT = ("OMPI_", "PMIX_", "ORTE_")  # prefixes of what Open MPI leaves in the environment
ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def environment() -> dict[str, str]:
    """That of this process without what Open MPI leaves there."""
    return {name: value for name, value in os.environ.items() if not name.startswith(LEFT)}

"""What tests of whole runs share: many of them, some killed."""

import pytest

from tests.system.kills import KillingForks


@pytest.fixture(scope="session")
def forks(all_forks):
    return KillingForks(all_forks)

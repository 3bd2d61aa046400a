"""A pipe before the camera by ray casting."""

import pytest
from casting import cast_pipe


@pytest.fixture
def pipe():
    return cast_pipe

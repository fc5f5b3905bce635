import pytest

from planner.scene.scene import Scene


@pytest.fixture
def make_scene():
    """Make a scene of lists of tables, as a file would hold them."""

    def make(surface, light, viewer):
        lists = {"surface": surface, "light": light, "viewer": viewer}
        return Scene.model_validate(
            {name: each if isinstance(each, list) else [each] for name, each in lists.items()}
        )

    return make

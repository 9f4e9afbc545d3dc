import subprocess
import sys

import pcg


def test_every_public_name_exists():
    """`__all__` lists what can be imported from the package, in order."""
    assert all(hasattr(pcg, name) for name in pcg.__all__)
    assert pcg.__all__ == sorted(pcg.__all__)


def test_importing_the_package_is_light():
    """No compiler, no learning library and no other package of the project is loaded."""
    heavy = "{'numba', 'torch', 'gymnasium', 'casadi', 'ompl', 'cv2', 'pymunk', 'shapely', 'converter'}"
    code = f"import sys, pcg; print(*sorted({heavy} & set(sys.modules)))"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)  # noqa: S603  # a fixed command
    assert loaded.stdout.split() == []

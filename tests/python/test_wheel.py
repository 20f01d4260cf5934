"""The wheel of scripts/wheel, which these tests run on."""

import pathlib
import re
import zipfile

import pytest

WHEELS = list((pathlib.Path(__file__).resolve().parent.parent.parent / "build" / "wheels").glob("*.whl"))


@pytest.fixture
def wheel():
    assert len(WHEELS) == 1
    return WHEELS[0]


def test_the_wheel_is_a_small_one_for_many_linuxes(wheel):
    assert re.fullmatch(r"graphdrl-[\d.]+-cp3\d+-(cp311|abi3)-manylinux_2_\d\d_\w+\.whl", wheel.name)
    assert wheel.stat().st_size < 10_000_000


def test_the_wheel_holds_the_package_its_types_and_no_torch(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    assert {"graphdrl/__init__.py", "graphdrl/_core.pyi", "graphdrl/py.typed"} <= set(names)
    libraries = [name for name in names if name.startswith("graphdrl.libs/lib")]
    assert any("libClp" in name for name in libraries)
    assert not [name for name in names if re.search("torch|openblas|tests?/", name)]
    licences = {name.split("/licenses/")[1] for name in names if "/licenses/" in name}
    assert {"LICENSE", "coinor-libclp1", "libcairo2", "liblapack-dev", "libtbb12"} <= licences

"""The API reference: builds without a warning, leaves nothing out, fetches nothing; docstrings say what they should."""

import inspect
import pathlib
import re
import subprocess
import sys
import zlib

import graphdrl
import graphdrl.environments
import graphdrl.published
import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
MODULES = (graphdrl, graphdrl.environments, graphdrl.published)
OURS = re.compile(r"graphdrl(\.|$)")  # modules whose classes are ours


def documented(cls):
    """Public methods and properties of a class, with those of its private bases: name, and the function or property."""
    ours = [base for base in cls.__mro__ if OURS.match(base.__module__) and (base is cls or base.__name__[0] == "_")]
    for name in sorted({name for base in ours for name in vars(base) if not name.startswith("_")}):
        member = inspect.getattr_static(cls, name)
        member = getattr(member, "__func__", member)
        if callable(member) or isinstance(member, property):
            yield name, member


def public():
    """Every public name with what it is: functions, classes, methods and properties."""
    for module in MODULES:
        for name in module.__all__:
            value = getattr(module, name)
            yield f"{module.__name__}.{name}", value
            if inspect.isclass(value):
                for member_name, member in documented(value):
                    yield f"{module.__name__}.{name}.{member_name}", member


EVERYTHING = dict(public())
CALLABLES = {name: value for name, value in EVERYTHING.items() if callable(value) or isinstance(value, property)}

# One of pytest's processes makes the pages for all of them.
pytestmark = pytest.mark.xdist_group("docs")


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    folder = tmp_path_factory.mktemp("docs") / "html"
    command = [sys.executable, "-m", "sphinx", "--fail-on-warning", "--keep-going", "--nitpicky", "--builder", "html"]
    done = subprocess.run(
        [*command, "-d", folder.parent / "doctrees", ROOT / "docs" / "api", folder],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return folder


def test_every_public_name_has_an_entry(pages):
    lines = zlib.decompress((pages / "objects.inv").read_bytes().split(b"\n", 4)[4]).decode().splitlines()
    entries = {line.split(" ")[0]: line.split(" ")[3] for line in lines if re.match(r"\S+ py:", line)}
    assert set(EVERYTHING) - set(entries) == set()
    for name in EVERYTHING:
        page, _, anchor = entries[name].partition("#")
        assert f'id="{anchor.replace("$", name)}"' in (pages / page).read_text(encoding="utf-8"), name
    fields = {f"graphdrl.FirstVisits.{field}" for field in graphdrl.FirstVisits._fields}
    assert fields <= set(entries) and "Alias for field number" not in (pages / "policies.html").read_text()


def test_the_headers_are_there(pages):
    text = re.sub(r"<[^>]+>", "", (pages / "c_cpp.html").read_text(encoding="utf-8"))
    assert "graphdrl_plan(" in text and "class World" in text


def test_a_page_fetches_nothing_from_elsewhere(pages):
    for page in pages.glob("*.html"):
        fetched = re.findall(r"<(?:script|img|link|iframe)\b[^>]*?\b(?:src|href)=\"([^\"]+)\"", page.read_text())
        assert fetched and not [address for address in fetched if re.match(r"(\w+:)?//", address)], page.name
    for style in (pages / "_static").glob("*.css"):
        assert not re.search(r"url\([\"']?(\w+:)?//|@import [\"'](\w+:)?//", style.read_text()), style.name


@pytest.mark.parametrize("name", sorted(CALLABLES))
def test_everything_public_says_what_it_is(name):
    doc = CALLABLES[name].__doc__
    assert doc is not None
    text = re.sub(r"^\w+\(.*\) -> .*\n\n", "", doc)  # without the signature of a native function
    assert re.match(r"[A-Z][^\n]+ [^\n]+\.(\s|$)", text), doc


@pytest.mark.parametrize("name", sorted(name for name, value in CALLABLES.items() if inspect.isfunction(value)))
def test_docstrings_name_every_parameter(name):
    require_parameters(CALLABLES[name], CALLABLES[name].__doc__)


@pytest.mark.parametrize(
    "name", sorted(name for name in EVERYTHING if name.endswith(("Env", ".Run", ".PaperNetwork", ".Explorer")))
)
def test_docstrings_name_every_parameter_of_a_constructor(name):
    cls = EVERYTHING[name]
    docs = [cls.__doc__, cls.__init__.__doc__]
    if "VectorEnv" in name:
        single = name.replace("VectorEnv", "Env")
        assert f"as {single.rpartition('.')[2]}, with its options" in docs[0]
        docs.append(EVERYTHING[single].__doc__)
    require_parameters(cls.__init__, "\n".join(filter(None, docs)))


def require_parameters(function, doc):
    parameters = [one for one in inspect.signature(function).parameters if one not in ("self", "cls")]
    missing = [one for one in parameters if not re.search(rf"^ +{one}: \S", doc, re.MULTILINE)]
    assert not missing, missing

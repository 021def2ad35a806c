"""Which LLVM tracing runs on, and what happens where there is none fit for it."""

import subprocess
import sys

import pytest
from heliform.engines.core import runtime
from heliform.engines.core.errors import RuntimeMissing


@pytest.fixture
def fresh():
    """The module with nothing remembered, and again afterwards."""
    remembered = (runtime.llvms, runtime.choose, runtime.mitsuba)

    def forget():
        for function in remembered:
            function.cache_clear()

    forget()
    yield runtime
    forget()


def test_here_a_usable_llvm_is_found():
    choice = runtime.choose()
    assert choice.backend in ("llvm", "cuda")
    assert choice.backend == "cuda" or choice.library


def test_an_old_llvm_is_never_chosen(fresh, monkeypatch):
    old = runtime.Llvm("libLLVM-15.so", (15, 0, 7))
    new = runtime.Llvm("libLLVM-21.so", (21, 1, 6))
    monkeypatch.setattr(runtime, "llvms", lambda: (old, new))
    monkeypatch.setattr(runtime, "_has_cuda", lambda: False)
    assert runtime.choose().library == "libLLVM-21.so"
    runtime.choose.cache_clear()
    monkeypatch.setattr(runtime, "llvms", lambda: (old,))
    with pytest.raises(RuntimeMissing, match=r"only LLVM 15\.0\.7 is here"):
        runtime.mitsuba()


def test_no_llvm_at_all_is_said_in_one_sentence(fresh, monkeypatch):
    monkeypatch.setattr(runtime, "llvms", lambda: ())
    monkeypatch.setattr(runtime, "_has_cuda", lambda: False)
    with pytest.raises(RuntimeMissing, match="no LLVM is here") as error:
        runtime.mitsuba()
    assert "geometry, files and the other analyses work" in str(error.value)


def test_a_missing_or_other_mitsuba_is_said(fresh, monkeypatch):
    def missing(name):
        raise runtime.importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(runtime.importlib.metadata, "version", missing)
    assert runtime.choose().reason == "Mitsuba is not installed"
    runtime.choose.cache_clear()
    monkeypatch.setattr(runtime.importlib.metadata, "version", lambda name: "3.10.0")
    assert "3.10.0 is installed where 3.9.1 is needed" in runtime.choose().reason


def test_a_library_that_cannot_be_loaded_or_has_no_version_is_old(tmp_path):
    (tmp_path / "libLLVM.so").write_text("no library")
    assert runtime._probe(str(tmp_path / "libLLVM.so")) is None


def test_without_mitsuba_glass_and_studies_go_on():
    """In a process where Mitsuba and Dr.Jit cannot be imported at all."""
    program = (
        "import sys; sys.modules['mitsuba'] = sys.modules['drjit'] = None\n"
        "from heliform.engines.core.study import load_study\n"
        "from heliform.engines.glass import TABLE_1, glass_object\n"
        "import heliform.engines.light\n"
        "print(len(glass_object(TABLE_1['tube']).faces))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 200_000


@pytest.mark.parametrize(
    ("name", "version"),
    [
        ("libLLVM-15.so.1", (15, 0, 0)),
        ("libLLVM-14.0.6.so", (14, 0, 6)),
        ("libLLVM.so.19.1", (19, 1, 0)),
        ("libLLVM-a6b168f6.so.21.1", (21, 1, 0)),
        ("libLLVM.dylib", None),
        ("LLVM-C.dll", None),
    ],
)
def test_a_library_s_name_tells_its_version(name, version):
    found = runtime._named(name)
    assert (found.version if found else None) == version


def test_a_library_that_is_not_what_its_name_says_is_never_given_to_dr_jit(
    fresh, monkeypatch, tmp_path
):
    fake = tmp_path / "libLLVM.so.19.1"
    fake.write_text("no library")
    monkeypatch.setattr(runtime, "llvms", lambda: (runtime.Llvm(str(fake), (19, 1, 0)),))
    monkeypatch.setattr(runtime, "_has_cuda", lambda: False)
    with pytest.raises(RuntimeMissing, match="not the LLVM that its name says"):
        runtime.mitsuba()

#!/bin/sh
# Makes .venv: Python 3.13 and what pyproject.toml asks for. Does nothing where that is done already.
set -eu
cd "$(dirname "$0")/.."

ready=$({ pwd; cat pyproject.toml; } | cksum)
if [ "$(cat .venv/ready 2>/dev/null)" = "$ready" ]; then
    exit 0
fi

is_python_313() {
    "$1" -c 'import ensurepip, sys, venv; sys.exit(sys.version_info[:2] != (3, 13) or bool(sys.abiflags))' \
        >/dev/null 2>&1
}

find_python() {
    for python in python3.13 python3 "${PYENV_ROOT:-$HOME/.pyenv}"/versions/3.13*/bin/python; do
        if is_python_313 "$python"; then
            echo "$python"
            return
        fi
    done
    return 1
}

if ! is_python_313 .venv/bin/python; then
    if python=$(find_python); then
        "$python" -m venv --clear .venv
    elif ! uv venv --quiet --clear --seed --python 3.13 .venv 2>/dev/null; then
        echo "Heliform needs Python 3.13, which is neither on the PATH nor in pyenv nor in uv's reach;" \
            "install it, for example with “pyenv install 3.13” or “uv python install 3.13”." >&2
        exit 1
    fi
fi

echo "Installing what pyproject.toml asks for into .venv (the first time this downloads about 1 GB)."
PYTHONWARNINGS=ignore .venv/bin/python -m pip install --quiet --disable-pip-version-check --editable '.[blender,dev]'
echo "$ready" >.venv/ready

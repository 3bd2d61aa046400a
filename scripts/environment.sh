# Sourced by the programs beside it: changes to the project's folder and makes .venv with all that it needs.
# PYTHON chooses another interpreter than python3, HYDROLEK_VENV another folder than .venv.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

python="${PYTHON:-python3}"
venv="${HYDROLEK_VENV:-.venv}"
if ! command -v "$python" >/dev/null; then
  echo "$python is not installed; Python 3.10 or newer is needed (Debian, Ubuntu: apt-get install python3 python3-venv)" >&2
  exit 1
fi
if ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))'; then
  echo "$("$python" --version) is too old; Python 3.10 or newer is needed, named by PYTHON=/path/to/python3" >&2
  exit 1
fi

# The console's tests drive a browser where there is one.
extras=test,docs,realsense
for browser in chromium chromium-browser google-chrome; do
  if command -v "$browser" >/dev/null; then extras=test,docs,realsense,browser; fi
done

# What is installed depends on these; where they are as on the last run, there is nothing to do.
wanted="$({ pwd; "$python" -VV; echo "$extras"; cat pyproject.toml constraints.txt; } | sha256sum | cut -d' ' -f1)"
if [[ "$(cat "$venv/installed-for" 2>/dev/null)" != "$wanted" ]]; then
  if ! "$python" -c 'import venv, ensurepip' 2>/dev/null; then
    echo "$("$python" --version) cannot make virtual environments (Debian, Ubuntu: apt-get install python3-venv)" >&2
    exit 1
  fi
  echo "installing into $venv (a few minutes, once)" >&2
  "$python" -m venv --clear "$venv"
  "$venv/bin/python" -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable ".[$extras]"
  echo "$wanted" >"$venv/installed-for"
fi
export PATH="$PWD/$venv/bin:$PATH"

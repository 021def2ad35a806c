# Every target first makes .venv where it is missing or pyproject.toml has changed.

PYTHON := .venv/bin/python

.PHONY: help setup demo test test-all lint package bench clean
.DEFAULT_GOAL := help

help: ## say what can be made
	@sed -n 's/^\([a-z-]*\):.*## /\1|/p' Makefile | awk -F'|' '{ printf "make %-10s %s\n", $$1, $$2 }'

setup: ## make .venv with Python 3.13 and everything that is needed
	@tools/setup.sh

demo: setup ## trace a printed glass tube under a lamp into out/demo
	@.venv/bin/heliform demo --out out/demo

test: setup ## run the tests, and those that drive a Blender 5.2 where there is one
	@PYTHONHASHSEED=0 OPENBLAS_NUM_THREADS=1 $(PYTHON) -m pytest -q -rs -n 2 --dist loadfile -m "not slow and not ui"
	@$(PYTHON) -m pytest -q -rs -m "ui and not slow"

test-all: setup ## run every test, also those that take minutes
	@PYTHONHASHSEED=0 OPENBLAS_NUM_THREADS=1 $(PYTHON) -m pytest -q -rs -n 2 --dist loadfile -m "not ui"
	@$(PYTHON) -m pytest -q -rs -m ui

lint: setup ## check style, format and types
	@$(PYTHON) -m ruff check .
	@$(PYTHON) -m ruff format --check .
	@$(PYTHON) -m pyright

package: setup ## build the extension's zip for every platform into dist
	@$(PYTHON) tools/package.py

bench: setup ## measure speed and agreement against other programs
	@set -e; for script in bench/[a-z]*.py; do echo "$$script"; $(PYTHON) "$$script"; done

clean: ## remove what was made, but for .venv and downloaded wheels
	@rm -rf out dist build/stage build/lib build/bdist* .pytest_cache .ruff_cache .hypothesis *.egg-info
	@find . -path ./.venv -prune -o -name __pycache__ -type d -prune -exec rm -rf {} +

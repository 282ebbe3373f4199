.PHONY: run test setup lint

run: setup
	.venv/bin/railhead run uic54_thesis

test: setup lint
	.venv/bin/python -m pytest

setup:
	@./setup.sh

lint: setup
	.venv/bin/ruff check .
	.venv/bin/ruff format --check .
	.venv/bin/mypy

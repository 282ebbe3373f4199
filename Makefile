.PHONY: run test test-all setup lint docs peers deb
STUDIES = accuracy-cost effect-accuracy error-bounds load-sweep scaling ranks thesis effects plasticity creep profiles hard-cases fuzz
ROOMS = cases meshing postprocess solver theory

run: setup
	.venv/bin/railhead run uic54_thesis

test: setup lint
	.venv/bin/python -m pytest -n 2 --dist worksteal

test-all: setup lint
	.venv/bin/python -m pytest -n 2 --dist worksteal -m "" --hypothesis-profile=thorough

setup:
	@./setup.sh

# Every table and picture under docs/: about fifty minutes on two cores.
docs: setup
	set -e; for study in $(STUDIES); do \
	    .venv/bin/railhead study $$study --out results/$$study; \
	    cp results/$$study/page.md docs/$$study.md; \
	    cp results/$$study/*.csv docs/; \
	    cp results/$$study/*.png docs/ 2>/dev/null || true; \
	done
	cat results/scaling/page.md >> docs/accuracy-cost.md
	PYTHONPATH=. .venv/bin/python -P tests/pages.py docs/tutorial.md docs/nitsche.md
	.venv/bin/railhead run uic54_thesis
	cp results/uic54_thesis/wheel_rail.png docs/uic54_thesis.png

# docs/peers.md: installs other codes (2.6 GB, in results/peers/venv and from Debian), so `docs` has it not.
peers: setup
	.venv/bin/railhead study peers --install
	cp results/peers/page.md docs/peers.md
	cp results/peers/peers.csv results/peers/peers.png docs/

# railhead_VERSION+SUITE_ARCH.deb, for the Debian that it is made on.
deb: setup
	./deb.sh

# mypy and import-linter see the rooms as one package: a folder of links.
lint: setup
	.venv/bin/ruff check .
	.venv/bin/ruff format --check .
	rm -rf .built && mkdir -p .built/railhead
	ln -s $(CURDIR)/railhead/* $(addprefix $(CURDIR)/,$(ROOMS)) .built/railhead
	ln -s $(CURDIR)/studies $(CURDIR)/tests/block_pairs.py .built
	MYPYPATH=.built .venv/bin/mypy -p railhead -p studies
	cd .built && ../.venv/bin/lint-imports --config ../pyproject.toml --no-cache && cd ..

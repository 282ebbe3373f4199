.PHONY: run page test pytest test-all setup lint docs peers deb pip-check site
STUDIES = accuracy-cost effect-accuracy scaling ranks thesis effects plasticity passes creep profiles hard-cases fuzz speed
ROOMS = cases meshing postprocess solver theory

# Compiled modules and tests are kept, whatever the environment says.
unexport PYTHONDONTWRITEBYTECODE

run: setup
	.venv/bin/railhead run uic54_thesis

# Wheel and rail in a browser.
page: setup
	.venv/bin/python -m pip install -q -c .venv/constraints.txt -e '.[page]'
	.venv/bin/railhead page

# Style and types on one core while the tests begin on the other.
test: setup
	@$(MAKE) --no-print-directory -j2 lint pytest

pytest:
	.venv/bin/python -m pytest -n 2 --dist worksteal

test-all: setup lint site
	.venv/bin/python -m pytest -n 2 --dist worksteal -m "" --hypothesis-profile=thorough

setup:
	@./setup.sh

# The tables and pictures of studies under docs/, but for error-bounds and peers: about fifty minutes on two cores.
docs: setup
	set -e; for study in $(STUDIES); do \
	    .venv/bin/railhead study $$study --out results/$$study; \
	    page=$$study; [ $$study != passes ] || page=passes-study; \
	    cp results/$$study/page.md docs/$$page.md; \
	    cp results/$$study/*.csv docs/; \
	    cp results/$$study/*.png docs/ 2>/dev/null || true; \
	done
	PYTHONPATH=. .venv/bin/python -P tests/docs/pages.py docs/tutorial.md docs/nitsche.md docs/gallery.md \
	    docs/howto-*.md docs/contact-program.md docs/solver.md
	.venv/bin/railhead run uic54_thesis
	cp results/uic54_thesis/wheel_rail.png docs/uic54_thesis.png

# The pages as a site, results/site/index.html; ends at a warning (a dead link, a page on no shelf).
site: .venv-site/installed
	rm -rf results/site
	.venv-site/bin/sphinx-build -q -W --keep-going -E -d .built/site docs results/site

.venv/installed: setup ;

.venv-site/installed: .venv/installed
	/usr/bin/python3 -m venv --clear --system-site-packages .venv-site
	.venv-site/bin/python -m pip install -q -c .venv/constraints.txt $$(.venv/bin/python -c \
	    'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["project"]["optional-dependencies"]["site"])')
	touch $@

# docs/peers.md: installs other codes (in results/peers/venv and from Debian), so `docs` has it not.
peers: setup
	.venv/bin/python -c "from studies.peers import peers_study; peers_study.install()"
	.venv/bin/railhead study peers
	cp results/peers/page.md docs/peers.md
	cp results/peers/peers.csv results/peers/peers.png docs/

# The way by pip: sdist and wheel, a venv of Python 3.12 or later with nothing of the system, dolfinx from PyPI.
pip-check: setup
	./pip-check.sh

# railhead_VERSION+SUITE_ARCH.deb, for the Debian that it is made on.
deb: setup
	./deb.sh

# mypy and import-linter see the rooms as one package: a folder of links. Types hold under one numpy, whatever Debian has.
lint: setup
	.venv/bin/ruff check .
	.venv/bin/ruff format --check .
	rm -rf .built && mkdir -p .built/railhead
	ln -s $(CURDIR)/railhead/* $(addprefix $(CURDIR)/,$(ROOMS)) .built/railhead
	ln -s $(CURDIR)/studies .built
	MYPYPATH=.built:.venv/stubs .venv/bin/mypy -p railhead -p studies
	cd .built && ../.venv/bin/lint-imports --config ../pyproject.toml --no-cache && cd ..

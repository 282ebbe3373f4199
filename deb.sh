#!/bin/sh
# Build railhead_VERSION+SUITE_ARCH.deb for the Debian that this runs on: /opt/railhead/venv holds the program and
# what it has from PyPI; dolfinx, petsc4py, numpy and scipy stay Debian's, as packages that it depends on.
set -eu
cd "$(dirname "$0")"

version=$(sed -n 's/^version = "\(.*\)"$/\1/p' pyproject.toml)+$(. /etc/os-release && echo "$VERSION_CODENAME")
depends=$(sed -n '/^packages="/,/"$/p' setup.sh | tr -d '"' | sed 's/^packages=//' | xargs printf '%s, ' | sed 's/python3-venv, //; s/, $//')
architecture=$(dpkg --print-architecture)
python=$(/usr/bin/python3 -c 'import sys; print(f"{sys.version_info[0]}.{sys.version_info[1]}")')
next=$(/usr/bin/python3 -c 'import sys; print(f"{sys.version_info[0]}.{sys.version_info[1] + 1}")')

root=.built/deb
venv=$root/opt/railhead/venv
rm -rf "$root" build
mkdir -p "$root/DEBIAN" "$root/usr/bin" "$root/usr/share/doc/railhead"

# Everything comes into the environment as if Debian had nothing, so that no package of this machine is missed on
# another one. Then numpy and scipy go, in the versions of Debian's, which take their place.
/usr/bin/python3 -m venv --without-pip "$venv"
.venv/bin/python -m pip --python "$venv/bin/python" install -q -c .venv/constraints.txt .
.venv/bin/python -m pip --python "$venv/bin/python" uninstall -q -y numpy scipy
rm -rf build railhead_contact.egg-info
sed -i 's/^include-system-site-packages = false/include-system-site-packages = true/; /^command/d' "$venv/pyvenv.cfg"
find "$venv/bin" -type f ! -name railhead -delete
sed -i '1s|.*|#!/opt/railhead/venv/bin/python3|' "$venv/bin/railhead"
/usr/bin/python3 -m compileall -q -f -s "$root" -p / "$venv" || true # templates of other packages are no Python
ln -s /opt/railhead/venv/bin/railhead "$root/usr/bin/railhead"
cp LICENSE "$root/usr/share/doc/railhead/copyright"

cat > "$root/DEBIAN/control" << END
Package: railhead
Version: $version
Architecture: $architecture
Maintainer: railhead maintainers <railhead@example.org>
Installed-Size: $(du -sk "$root" | cut -f1)
Depends: python3 (>= $python~), python3 (<< $next~), $depends
Section: science
Priority: optional
Description: wheel-rail contact by finite elements
 Contact patch, pressure and stresses of a wheel on a rail, each number with an estimate of its error.
END

dpkg-deb --root-owner-group -Zzstd --build "$root" "railhead_${version}_$architecture.deb"

#!/usr/bin/env python3
"""The Debian packages: made by cpack, without an error by lintian, installed in a root of their own, used there and
removed without a trace. With ABBE_BARE=1 in a bare Debian, where apt finds what they depend on.

    ABBE_BUILD=build/dev debian_packages_test.py
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(os.environ["ABBE_BUILD"]).resolve()
IS_BARE = os.environ.get("ABBE_BARE") == "1"
# Kept by dpkg and apt themselves, or caches of what was installed beside.
OF_DPKG = ("var/lib/dpkg", "var/log", "var/lib/apt", "var/cache")


def run(*command, **options):
    """What a command prints; it must succeed."""
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise AssertionError(f"{command}: exit code {done.returncode}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


def files_below(root):
    """The names of all files and folders but those of dpkg itself."""
    names = {path.relative_to(root).as_posix() for path in root.rglob("*")}
    return {name for name in names if not name.startswith(OF_DPKG)}


class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.path = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        run("cpack", "-G", "DEB", "--config", BUILD / "CPackConfig.cmake", "-B", cls.path / "made")
        made = sorted((cls.path / "made").glob("*.deb"))
        cls.debs = {run("dpkg-deb", "-f", deb, "Package").strip(): deb for deb in made}

    def field(self, package, name):
        return run("dpkg-deb", "-f", self.debs[package], name).strip()


@unittest.skipIf(IS_BARE, "the bare Debian only")
class MadeTest(Packages):
    def test_all_are_there_and_depend_on_what_they_load(self):
        self.assertLessEqual({"abbe", "libabbe-dev", "abbe-doc"}, set(self.debs))
        for package in {"abbe", "python3-abbe"} & set(self.debs):
            depends = self.field(package, "Depends")
            for library in ("libc6 (>=", "libfmt", "libhdf5", "libhwy", "libtbb", "libopenblas0-pthread"):
                self.assertIn(library, depends, package)
        self.assertIn("libceres-dev", self.field("libabbe-dev", "Depends"))
        self.assertNotIn("npm", self.field("libabbe-dev", "Depends"))
        self.assertEqual(self.field("abbe-doc", "Architecture"), "all")
        if "python3-abbe" in self.debs:
            self.assertIn("python3-numpy", self.field("python3-abbe", "Depends"))

    def test_each_has_licence_and_changelogs(self):
        for package, deb in self.debs.items():
            names = run("dpkg-deb", "-c", deb)
            for file in ("copyright", "changelog.gz", "changelog.Debian.gz"):
                self.assertIn(f"./usr/share/doc/{package}/{file}\n", names)

    def test_the_manual_has_its_site(self):
        """Where it was built (target site); setup/packages builds it."""
        site = BUILD / "site"
        names = set(re.findall(r"\./usr/share/doc(?:/abbe/html|-base)/(\S+)$", run("dpkg-deb", "-c", self.debs["abbe-doc"]), re.M))
        if not (site / "index.html").exists():
            self.assertEqual(names, set())
            return
        built = {path.relative_to(site).as_posix() for path in site.rglob("*.html")}
        self.assertLessEqual(built | {"search/search_index.json", "abbe-doc.abbe"}, names)

    @unittest.skipUnless(shutil.which("lintian"), "needs lintian")
    def test_lintian_finds_no_error(self):
        done = subprocess.run(["lintian", "--allow-root", *self.debs.values()], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertNotRegex(done.stdout, "(?m)^E:")

    @unittest.skipUnless(os.geteuid() == 0, "dpkg --root needs root")
    def test_installed_used_and_removed(self):
        """In a root that holds nothing else; the libraries are those of this system."""
        root = self.path / "root"
        for folder in ("var/lib/dpkg/info", "var/lib/dpkg/updates", "var/log"):
            (root / folder).mkdir(parents=True)
        (root / "var/lib/dpkg/status").touch()
        before = files_below(root)
        dpkg = ("dpkg", f"--root={root}", "--force-depends", "--force-script-chrootless")
        run(*dpkg, "-i", *self.debs.values())
        for file in ("bin/abbe", "share/man/man1/abbe-sweep.1.gz", "share/bash-completion/completions/abbe",
                     "share/zsh/vendor-completions/_abbe", "share/fish/vendor_completions.d/abbe.fish",
                     "include/abbe/map/error_map.h", "lib/cmake/abbe/abbeConfig.cmake", "share/doc/abbe/docs/sweep.md"):
            self.assertTrue((root / "usr" / file).is_file(), file)
        program, machine = root / "usr/bin/abbe", root / "usr/share/abbe/machines/demo_mill.toml"
        work = self.path / "work"
        work.mkdir()
        use(lambda *command: run(*command, cwd=work), program, machine)
        self.assertIn("<html", (work / "report.html").read_text()[:2000].lower())
        if "python3-abbe" in self.debs:
            tips = run("/usr/bin/python3", "-c", "import abbe; print(abbe.PivotLinkage(1, 2).tips([[0, 0, 0]]))",
                       env={"PYTHONPATH": str(root / "usr/lib/python3/dist-packages"), "PYTHONDONTWRITEBYTECODE": "1"})
            self.assertEqual(tips, "[[1. 0. 2.]]\n")
        run(*dpkg, "-P", *self.debs)
        self.assertEqual(files_below(root) - before, set())


def use(run_there, program, machine):
    """A sweep of the demo's machine, reduced and reported, in a folder of its own."""
    run_there(program, "rig", "record", "--machine", machine, "--seed", "7", "--axis", "X", "--out", "sweep.csv")
    table = run_there(program, "reduce", "sweep.csv", "--machine", machine, "--json", "sweep.json")
    assert "EYX" in table, table
    run_there(program, "report", ".", "--out", "report.html")


@unittest.skipUnless(IS_BARE, "ABBE_BARE=1 makes a bare Debian")
class BareTest(Packages):
    def bare(self):
        """A Debian of the release of this system, with nothing but what it needs."""
        release = dict(line.split("=", 1) for line in pathlib.Path("/etc/os-release").read_text().splitlines() if line)
        root = self.path / "bare"
        command = ["debootstrap", "--variant=minbase", release["VERSION_CODENAME"], str(root), "http://deb.debian.org/debian"]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            self.skipTest(f"no bare Debian could be made: {(done.stdout + done.stderr).strip().splitlines()[-1]}")
        return root

    def test_installed_used_and_removed(self):
        if os.geteuid() != 0 or not shutil.which("debootstrap"):
            self.skipTest("needs root and debootstrap")
        root = self.bare()

        def inside(*command):
            return run("chroot", root, "env", "DEBIAN_FRONTEND=noninteractive", "LC_ALL=C.UTF-8", *command)

        inside("apt-get", "update")
        before = files_below(root)
        (root / "packages").mkdir()
        for package in ("abbe", "abbe-doc", "python3-abbe"):
            if package in self.debs:
                shutil.copy(self.debs[package], root / "packages")
        names = [f"/packages/{deb.name}" for deb in (root / "packages").glob("*.deb")]
        inside("apt-get", "install", "-y", "--no-install-recommends", *names)
        (root / "work").mkdir()
        use(lambda *command: inside("env", "-C", "/work", *command), "abbe", "/usr/share/abbe/machines/demo_mill.toml")
        if "python3-abbe" in self.debs:
            text = inside("python3", "-c", "import abbe; print(abbe.read_machine('/usr/share/abbe/machines/demo_mill.toml'))")
            self.assertIn("demo-mill", text)
        inside("apt-get", "purge", "-y", *(name for name in self.debs if name != "libabbe-dev"))
        left = {name for name in files_below(root) - before if "abbe" in name and not name.startswith("packages")}
        self.assertEqual(left, set())


if __name__ == "__main__":
    result = unittest.main(exit=False).result
    reasons = [reason for test, reason in result.skipped if isinstance(test, BareTest) == IS_BARE]
    if result.wasSuccessful() and reasons:
        print("skipped:", "; ".join(reasons))
        sys.exit(77)
    sys.exit(not result.wasSuccessful())

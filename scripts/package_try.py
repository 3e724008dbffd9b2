#!/usr/bin/env python3
"""Follows the documentation from the packages, as a new user would: each page in a fresh Debian 12 of its own.

    scripts/package_try.py FOLDER [PAGE.md …]      packages of FOLDER; without pages: docs/index.md and docs/tutorials

A page names its packages ("Packages: `docent`, `curl`."). They alone are installed, Docent's own from FOLDER, and each command of the
page is run there and its output compared. Needs root and debootstrap. The fresh system is made once, and kept
beside the temporary files.
"""
import argparse
import contextlib
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
BASE = pathlib.Path(tempfile.gettempdir()) / "docent-package-root"
MIRROR = "http://deb.debian.org/debian"
ENVIRONMENT = {"PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin", "HOME": "/root", "LC_ALL": "C.UTF-8",
               "DEBIAN_FRONTEND": "noninteractive"}


def run(*argv, **options):
    subprocess.run([str(a) for a in argv], check=True, **options)


def packages_of(page):
    """The packages that the page says are enough."""
    line = re.search(r"^Packages: (.+)$", page.read_text(), re.M)
    if not line:
        sys.exit(f"{page}: names no packages; write \"Packages: `docent`.\"")
    return re.findall(r"`([^`]+)`", line[1])


def fresh_system():
    """A Debian 12 with nothing but what every system has, and its list of packages."""
    if not (BASE / "etc/debian_version").exists():
        shutil.rmtree(BASE, ignore_errors=True)
        BASE.parent.mkdir(exist_ok=True)
        print("package: making a fresh Debian 12", file=sys.stderr)
        run("debootstrap", "--variant=minbase", "bookworm", BASE, MIRROR, stdout=subprocess.DEVNULL)
    with system_of(BASE):
        in_system(BASE, "apt-get", "update", "-q")
    return BASE


@contextlib.contextmanager
def system_of(root):
    """The folder as a system that can run programs and reach package servers."""
    shutil.copyfile("/etc/resolv.conf", root / "etc/resolv.conf")
    run("mount", "-t", "proc", "proc", root / "proc")
    run("mount", "--rbind", "--make-rslave", "/dev", root / "dev")
    try:
        yield root
    finally:
        run("umount", "-l", root / "dev")
        run("umount", root / "proc")


@contextlib.contextmanager
def copy_of(base):
    """A system like it that is thrown away."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="docent-try-"))
    try:
        for name in ("files", "changes", "work", "root"):
            (folder / name).mkdir()
        run("mount", "-t", "tmpfs", "tmpfs", folder / "files")  # an overlay takes no other overlay for its changes
        for name in ("changes", "work"):
            (folder / "files" / name).mkdir()
        layers = f"lowerdir={base},upperdir={folder}/files/changes,workdir={folder}/files/work"
        run("mount", "-t", "overlay", "overlay", "-o", layers, folder / "root")
        try:
            with system_of(folder / "root") as root:
                yield root
        finally:
            run("umount", folder / "root")
    finally:
        subprocess.run(["umount", folder / "files"], check=False)
        shutil.rmtree(folder, ignore_errors=True)


def in_system(root, *argv):
    done = subprocess.run(["chroot", root, *argv], env=ENVIRONMENT, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"package: {' '.join(argv)}\n{done.stdout}{done.stderr}")
    return done.stdout


def install(root, packages, folder):
    """Returns what apt says of the size."""
    (root / "tmp/packages").mkdir()
    names = []
    for package in packages:
        found = sorted(folder.glob(f"{package}_*.deb"))
        if found:
            shutil.copy(found[-1], root / "tmp/packages")
        names.append(f"/tmp/packages/{found[-1].name}" if found else package)
    said = in_system(root, "apt-get", "install", "-y", *names)
    return ", ".join(re.findall(r"\d+ newly installed|[\d.,]+ [kM]B of additional disk space", said))


def follow(page, base, folder):
    packages = packages_of(page)
    with copy_of(base) as root:
        size = install(root, packages, folder)
        print(f"{page.relative_to(ROOT)}: {' '.join(packages)}: {size}", flush=True)
        # A network of its own, in which the usual ports are free.
        command = "ip link set lo up && exec \"$0\" -B \"$@\""
        return subprocess.run(["unshare", "--net", "sh", "-c", command, sys.executable, ROOT / "scripts/tutorials", "--root", root, page]).returncode == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="of the packages")
    parser.add_argument("pages", nargs="*", type=pathlib.Path)
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # what was mounted is unmounted then, too
    pages = [page.resolve() for page in arguments.pages] or [ROOT / "docs/index.md", *sorted((ROOT / "docs/tutorials").glob("[0-9]*.md"))]
    base = fresh_system()
    bad = [page.name for page in pages if not follow(page, base, arguments.folder)]
    if bad:
        sys.exit(f"package: the packages are not enough, or the pages are wrong: {' '.join(bad)}")
    print(f"package: {len(pages)} pages, each followed from the packages that it names")


if __name__ == "__main__":
    main()

"""A copy of the tree with changes in it, each behind a switch that the environment sets, built once for all of them."""
import os
import re
import subprocess

from mutant_sites import render

SWITCH = r'''// Whether change `number` is made: that of the environment variable DOCENT_MUTANT is. Each place that a program comes to
// gets a mark in the file DOCENT_MUTANTS_REACHED, which is shared memory: a killed process leaves its marks, too.
#ifndef DOCENT_MUTANT_SWITCH_H_
#define DOCENT_MUTANT_SWITCH_H_
#pragma GCC diagnostic ignored "-Wtype-limits"
#pragma GCC diagnostic ignored "-Wparentheses"
#pragma GCC diagnostic ignored "-Wunused-value"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wint-in-bool-context"
#pragma GCC diagnostic ignored "-Wbool-compare"
#include <fcntl.h>
#include <sys/mman.h>

#include <cstdlib>

constexpr int kDocentMutants = 65536;

inline char* DocentMutantMarks() {
  const char* path = std::getenv("DOCENT_MUTANTS_REACHED");
  const int file = path == nullptr ? -1 : open(path, O_RDWR | O_CLOEXEC);
  void* marks = file < 0 ? MAP_FAILED : mmap(nullptr, kDocentMutants, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  return marks == MAP_FAILED ? nullptr : static_cast<char*>(marks);
}

inline bool DocentMutant(int number) {
  static const char* const text = std::getenv("DOCENT_MUTANT");
  static const int chosen = text == nullptr ? 0 : std::atoi(text);
  static char* const marks = DocentMutantMarks();
  if (marks != nullptr) marks[number] = 1;
  return number == chosen;
}

#endif  // DOCENT_MUTANT_SWITCH_H_
'''


def put(path, data):
    """Writes the file unless it is the same, which keeps what is built of it."""
    if path.exists() and path.read_bytes() == data:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)


def make_copy(root, tree, chosen):
    """chosen: {number: (file, site)}."""
    names = subprocess.run(["git", "-C", root, "ls-files", "-co", "--exclude-standard"], capture_output=True, text=True, check=True)
    files = {n for n in names.stdout.splitlines() if (root / n).is_file()}
    changed = {}
    for number, (file, site) in chosen.items():
        site.number = number
        changed.setdefault(file, []).append(site)
    for name in sorted(files):
        data = (root / name).read_bytes()
        if name in changed:
            text = render(data, changed[name], lambda site: f"DocentMutant({site.number})")
            data = f'#include "mutant_switch.h"\n#line 1\n{text}'.encode()
        put(tree / name, data)
        os.chmod(tree / name, (root / name).stat().st_mode)
    put(tree / "mutant_switch.h", SWITCH.encode())
    for path in [p for p in tree.rglob("*") if p.is_file()]:
        name = path.relative_to(tree).as_posix()
        if name not in files and name != "mutant_switch.h" and not name.startswith("build/"):
            path.unlink()


def build(tree, targets, jobs):
    """Builds in the copy. → the numbers of the changes that do not compile; exits where the fault is another."""
    if not (tree / "build/dev/build.ninja").exists():
        subprocess.run(["cmake", "--preset", "dev", "-DDOCENT_BUILD_BENCH=OFF"], cwd=tree, check=True, stdout=subprocess.DEVNULL)
    ninja = subprocess.run(["ninja", "-C", "build/dev", f"-j{jobs}", "-k", "0", *targets], cwd=tree, capture_output=True, text=True)
    if ninja.returncode == 0:
        return set()
    numbers = set()
    for name, line in re.findall(r"([\w./]+\.(?:cc|h)):(\d+):\d+: error", ninja.stdout):
        path = tree / "build/dev" / name
        if not path.exists():
            continue
        lines, at = path.read_text().splitlines()[2:], int(line) - 1
        for reach in (0, 2, 6):
            found = re.findall(r"DocentMutant\((\d+)\)", "\n".join(lines[max(0, at - reach):at + reach + 1]))
            if found:
                numbers |= set(map(int, found))
                break
    if not numbers:
        raise SystemExit("mutants: the copy does not build, and no change is at fault:\n" + ninja.stdout[-4000:])
    return numbers

"""What is installed: the files of the packages in a folder of this test, used from there.

Environment: DOCENT_BUILD, the folder that was built.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(os.environ["DOCENT_BUILD"])
ROOT = pathlib.Path(__file__).resolve().parents[2]


def run(*argv, **options):
    return subprocess.run([str(a) for a in argv], capture_output=True, text=True, timeout=600, **options)


class PackageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="docent-package-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.usr = cls.folder / "usr"
        for component in ("docent", "docent-robot", "docent-robot-replay", "docent-redland", "docent-dev"):
            done = run("cmake", "--install", BUILD, "--prefix", cls.usr, "--component", component)
            assert done.returncode == 0, done.stdout + done.stderr
        cls.docent = cls.usr / "bin" / "docent"

    def help(self, *words):
        done = run(self.docent, *words, "--help", env={**os.environ, "COLUMNS": "10000"})
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def commands(self, *words):
        """Every command with those below it, as lists of words."""
        for name in re.findall(r"^  ([a-z]+) {2,}\S", self.help(*words), re.M):
            yield [*words, name]
            yield from self.commands(*words, name)

    def test_no_path_of_the_source_tree_is_in_a_program(self):
        for program in (self.usr / "bin").iterdir():
            done = run("strings", "-d", "-n", "6", program)
            found = [line for line in done.stdout.splitlines() if str(ROOT) in line or str(BUILD) in line]
            self.assertEqual(found, [], program)

    def test_every_help_text_has_an_example_that_names_the_command(self):
        commands = list(self.commands())
        self.assertIn(["query"], commands)
        self.assertIn(["ontology", "diff"], commands)
        for words in commands:
            text = self.help(*words)
            self.assertRegex(text, r"Examples?:\n  docent " + words[0], words)

    def test_the_examples_of_the_help_texts_are_taken_by_the_command_line(self):
        # Asked with --help behind them: a word or option that there is none of would be told.
        for words in self.commands():
            for example in re.findall(r"^  (docent .*)$", self.help(*words).partition("Example")[2], re.M):
                done = run("bash", "-c", f"{example} --help", env={**os.environ, "PATH": f"{self.usr}/bin:/usr/bin:/bin"})
                self.assertEqual(done.returncode, 0, example + done.stderr)

    def test_the_settings_file_has_every_option_of_serve_with_its_default(self):
        text = (self.usr / "etc/docent/docent.toml").read_text()
        options = re.findall(r"^  --([a-z-]+)(?: \S+)?\s{2,}(.*)$", self.help("serve"), re.M)
        self.assertGreater(len(options), 10)
        for name, description in options:
            if name in ("help", "config", "print-config"):
                continue
            setting = re.search(rf"^(#?){name} = (.*)$", text, re.M)
            self.assertIsNotNone(setting, name)
            default = re.search(r"\(default: ([^)]*)\)", description)
            if default and name != "data":
                self.assertEqual((setting[1], setting[2].strip('"')), ("#", default[1]))
        self.assertIn('\ndata = "/var/lib/docent"\n', text)

    def test_the_settings_file_reads_back_as_it_is(self):
        settings = self.usr / "etc/docent/docent.toml"
        done = run(self.docent, "serve", "--config", settings, "--print-config")
        self.assertEqual(done.returncode, 0, done.stderr)
        head = (ROOT / "packaging/docent.toml.head").read_text()
        self.assertEqual(head + done.stdout, settings.read_text())

    def test_with_every_setting_uncommented_the_server_starts_as_without(self):
        text = re.sub(r"^#([a-z-]+ = )", r"\1", (self.usr / "etc/docent/docent.toml").read_text(), flags=re.M)
        changed = self.folder / "all.toml"
        changed.write_text(text.replace("/var/lib/docent", str(self.folder / "data"))
                           .replace("127.0.0.1:7400", "127.0.0.1:0").replace("127.0.0.1:7480", "127.0.0.1:0"))
        server = subprocess.Popen([self.docent, "serve", "--config", changed], stdout=subprocess.PIPE, text=True)
        try:
            self.assertRegex(server.stdout.readline(), r"^listening grpc=127\.0\.0\.1:\d+ http=127\.0\.0\.1:\d+$")
        finally:
            server.terminate()
            self.assertEqual(server.wait(60), 0)
            server.stdout.close()

    def test_the_man_pages_are_well_formed_and_name_every_command(self):
        for page, words in (("docent", ["whatif", "ontology diff", "/etc/docent/docent.toml"]), ("docent-robot", ["replay", "SIGUSR1"])):
            file = self.usr / "share/man/man1" / f"{page}.1.gz"
            if page == "docent-robot" and not file.exists():
                continue
            text = run("gzip", "-dc", file).stdout
            self.assertRegex(text, r'\.SH NAME\n' + page.replace("-", r"\\-") + r' \\- \w')
            for word in words:
                self.assertIn(word, text.replace("\\-", "-"))
            if shutil.which("groff"):
                self.assertEqual(run("groff", "-man", "-Kutf8", "-Tutf8", "-ww", "-z", input=text).stderr, "")

    def complete(self, line):
        """What bash offers behind `line`."""
        script = f'''source {self.usr}/share/bash-completion/completions/docent
COMP_WORDS=({line}); [[ "{line}" != *" " ]] || COMP_WORDS+=(""); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
_docent; printf '%s\\n' "${{COMPREPLY[@]}}"'''
        done = run("bash", "-c", script, cwd=self.folder, env={**os.environ, "PATH": f"{self.usr}/bin:/usr/bin:/bin"})
        return done.stdout.split()

    def test_bash_completes_commands_options_and_values(self):
        self.assertEqual(self.complete("docent que"), ["query"])
        self.assertIn("serve", self.complete("docent "))
        self.assertEqual(sorted(self.complete("docent ontology re")), ["remove", "replace"])
        self.assertEqual(self.complete("docent query --time"), ["--timeout-ms"])
        self.assertEqual(sorted(self.complete("docent query --format ")), ["csv", "json", "tsv", "xml"])
        (self.folder / "hall.ttl").write_text("")
        self.assertIn("hall.ttl", self.complete("docent load hal"))

    def test_the_robot_needs_the_light_half_of_mrpt_and_its_module_is_where_it_looks(self):
        loaded = run("ldd", self.usr / "bin/docent-robot").stdout
        self.assertIn("libmrpt-poses", loaded)
        self.assertNotRegex(loaded, "libmrpt-(img|maps|obs|opengl|slam|vision)|opencv|libgtk|libQt|gdal")
        self.assertTrue((self.usr / "lib/docent/docent_mrpt_files.so").is_file())

    def calls_of(self, script, *arguments, installed_before, enabled=False):
        """What a script of the package calls of systemd's helpers."""
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder) / "log"
            helper = f"""#!/bin/sh
[ "$1" = debian-installed ] && exit {0 if installed_before else 1}
case "$*" in *was-enabled*) exit {0 if enabled else 1} ;; esac
echo "$(basename $0) $*" >> {log}
"""
            for name in ("deb-systemd-helper", "deb-systemd-invoke", "systemctl"):
                (pathlib.Path(folder) / name).write_text(helper)
                (pathlib.Path(folder) / name).chmod(0o755)
            text = (ROOT / "packaging/debian" / script).read_text().replace("-d /run/systemd/system", "-d /")
            done = run("sh", "-c", text, script, *arguments, env={"PATH": f"{folder}:/usr/bin:/bin"})
            self.assertEqual(done.returncode, 0, done.stderr)
            return log.read_text()

    def test_a_new_installation_starts_and_enables_nothing(self):
        calls = self.calls_of("postinst", "configure", "", installed_before=False)
        for word in (" enable ", " start ", " restart ", "try-restart"):
            self.assertNotIn(word, f" {calls} ")

    def test_an_upgrade_starts_a_server_again_that_runs_and_keeps_it_enabled(self):
        calls = self.calls_of("postinst", "configure", "0.0.9", installed_before=True, enabled=True)
        self.assertIn("deb-systemd-invoke try-restart docent.service", calls)
        self.assertIn("deb-systemd-helper enable docent.service", calls)
        self.assertNotIn(" enable ", self.calls_of("postinst", "configure", "0.0.9", installed_before=True))

    def test_the_definitions_of_the_api_come_with_the_server(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(run("cmake", "--install", BUILD, "--prefix", folder, "--component", "docent").returncode, 0)
            self.assertTrue((pathlib.Path(folder) / "share/docent/proto/docent/v1/context.proto").is_file())

    def test_the_unit_is_one_that_systemd_takes(self):
        if not shutil.which("systemd-analyze"):
            self.fail("systemd-analyze is missing; scripts/setup test installs it")
        unit = (self.usr / "lib/systemd/system/docent.service").read_text()
        # The unit names the programs where the build will be installed; here they are elsewhere.
        unit = re.sub(r"^ExecStart=\S+", f"ExecStart={self.docent}", unit, flags=re.M)
        file = self.folder / "docent.service"
        file.write_text(unit)
        done = run("systemd-analyze", "verify", "--man=no", file)
        self.assertEqual((done.returncode, done.stdout + done.stderr), (0, ""))

    def test_an_adapter_is_built_with_the_installed_sdk_alone(self):
        build = self.folder / "sdk"
        done = run("cmake", "-S", ROOT / "tests/package/sdk_client", "-B", build, f"-DCMAKE_PREFIX_PATH={self.usr}", "-G", "Ninja")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        done = run("cmake", "--build", build, "--verbose")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertNotIn(str(ROOT / "robot_adapters"), done.stdout)
        adapter = subprocess.Popen([build / "blinker"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        lines = iter(adapter.stdout.readline, "")
        told = next((line for line in lines if not line.startswith("[")), "")  # warnings that no server is there stand there, too
        self.assertRegex(told, r"^listening 127\.0\.0\.1:\d+$")
        adapter.communicate("\n", timeout=60)
        self.assertEqual(adapter.returncode, 0)

    def test_every_installed_header_has_what_it_includes(self):
        include = self.usr / "include" / "docent"
        headers = sorted(p.relative_to(include) for p in include.rglob("*.h"))
        self.assertIn(pathlib.Path("robot_adapters/sdk/robot_adapter.h"), headers)
        for header in headers:
            for name in re.findall(r'^#include "((?:graph|robot_adapters|kb_server|docent)/[^"]+)"', (include / header).read_text(), re.M):
                self.assertTrue((include / name).exists(), f"{header} includes {name}")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v", *sys.argv[1:]])

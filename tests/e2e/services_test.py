#!/usr/bin/env python3
"""Robot services with real processes: described with types, generated, versioned, composed, imported."""
import json
import re
import unittest

from docent_e2e import PATIENCE_S, StageTest, stage

ROBOT = "https://w3id.org/docent/expo#R07"
WSDL = """<definitions targetNamespace="urn:t" xmlns:t="urn:t" xmlns="http://schemas.xmlsoap.org/wsdl/"
    xmlns:xs="http://www.w3.org/2001/XMLSchema"><message name="M"><part name="text" type="xs:string"/></message>
  <portType name="Voice"><operation name="say"><input message="t:M"/></operation></portType></definitions>
"""
OUTER = """<rsel name="Outer"><message name="In"><part name="place"/><part name="text"/></message>
  <process name="visit" input="In"><invoke operation="Tour"/><invoke operation="go"><input part="place" from="place"/></invoke></process>
</rsel>
"""


class Services(StageTest):
    def setUp(self):
        super().setUp()
        self.server = self.stage.server()
        stage.load_ontology(self.server)
        self.adapter = self.stage.start("adapter", [
            self.stage.bin / "docent-scripted-adapter", "--server", self.server.grpc, "--robot", ROBOT,
            "--operation", "go:place=docent:Region", "--operation", "say:text=xsd:string", "--take-ms", "400",
            "--journal", self.stage.folder / "adapter.journal"])
        self.server.wait_for(f"<{ROBOT}> docent:status docent:Standby", PATIENCE_S)

    def services(self, *arguments, **options):
        return self.server.run("services", *arguments, **options)

    def good(self, *arguments, **options):
        done = self.services(*arguments, **options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def refused(self, *arguments):
        done = self.services(*arguments)
        self.assertNotEqual(done.returncode, 0, done.stdout)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        return done.stderr

    def generated(self):
        file = self.file("tour.rsel.xml", self.good("generate", "--name", "Tour", "go", "say"))
        self.server.load(file)
        return file

    def test_generated_registered_described_and_invoked(self):
        file = self.generated()
        self.assertIn("ok", self.docent("check", file).stdout)
        self.assertEqual(self.docent("fmt", "--check", file).returncode, 0)
        shown = self.good("show", "Tour")
        self.assertIn("takes     place (docent:Region), text (xsd:string)", shown)
        self.assertIn("1/2 go", shown)
        self.assertIn("version 1", shown)
        invoked = self.good("invoke", "Tour", "--arg", "place=<urn:p>", "--arg", "text=hello")
        self.assertRegex(invoked, r"1/2 go")
        self.assertRegex(invoked, r" \d+ %")
        self.assertEqual(self.good("--invoke", "Tour", "--arg", "place=<urn:p>", "--arg", "text=hello").splitlines()[-1].split()[-1],
                         "done", "the old way still works")
        self.assertIn("it takes place (docent:Region) and text (xsd:string)", self.refused("invoke", "Tour", "--arg", "place=3"))
        self.assertIn("there is no robot", self.refused("invoke", "Tour", "--arg", "place=<urn:p>", "--arg", "text=x", "--robot", "urn:absent"))
        self.assertIn("did you mean Tour?", self.refused("invoke", "Tuor"))
        self.assertIn("did you mean say?", self.refused("generate", "sya"))

    def test_versions_survive_a_kill(self):
        file = self.generated()
        self.server.load(file)
        file.write_text(file.read_text().replace('version="1.0"', 'version="1.1"'))
        self.server.load(file)
        self.server.kill()
        self.server.start()
        rows = [json.loads(line) for line in self.good("versions", "Tour", "--json").splitlines()]
        self.assertEqual([(row["number"], row["version"], row["live"]) for row in rows], [(1, "1.0", False), (2, "1.1", True)])
        diff = self.services("diff", "Tour")
        self.assertEqual(diff.returncode, 1)
        self.assertRegex(diff.stdout, r'(?m)^-.*version="1.0"')
        self.assertRegex(diff.stdout, r'(?m)^\+.*version="1.1"')
        self.assertIn('version="1.0"', self.good("show", "Tour", "--version", "1"))
        self.assertIn("no version 7", self.refused("show", "Tour", "--version", "7"))

    def test_composed_shown_and_removed(self):
        self.generated()
        self.server.load(self.file("outer.rsel.xml", OUTER))
        self.assertIn("process visit of document Outer", self.refused("remove", "Tour"))
        run = self.good("invoke", "visit", "--arg", "place=<urn:p>", "--arg", "text=hello").split()[0]
        shown = self.server.command("runs", run)
        for step in ("1/3 Tour/go", "2/3 Tour/say", "3/3 go"):
            self.assertRegex(shown, re.escape(step) + "  done")
        self.good("remove", "Outer")
        self.good("remove", "Tour")
        self.assertIn("no robot service is registered", self.services().stderr)
        self.assertIn("1.0", self.good("versions", "Tour"))
        recursion = self.file("circle.rsel.xml", OUTER.replace('"Tour"', '"again"').replace("</rsel>", '<process name="again" input="In"><invoke operation="visit"/></process></rsel>'))
        self.assertIn("contains itself: again → visit → again", self.docent("check", recursion).stderr)

    def test_imports(self):
        node = self.docent("services", "import", self.file("voice.wsdl", WSDL))
        self.assertIn('<part name="text" type="xsd:string"/>', node.stdout)
        self.assertIn('<invoke operation="say"/>', node.stdout)
        address = re.search(r"grpc=(\S+)", self.adapter.output()).group(1)
        of_adapter = self.docent("services", "import", "adapter", address, "--json")
        self.assertEqual([json.loads(line)["operation"] for line in of_adapter.stdout.splitlines()], ["go", "say"])
        of_server = self.docent("services", "import", "grpc", self.server.grpc, "--json")
        self.assertIn("docent.v1.Workflows", [json.loads(line)["service"] for line in of_server.stdout.splitlines()])
        silent = self.docent("services", "import", "grpc", address)
        self.assertIn("has no server reflection", silent.stderr)
        absent = self.docent("services", "import", "grpc", "127.0.0.1:1")
        self.assertEqual(len(absent.stderr.strip().splitlines()), 1, absent.stderr)
        self.assertIn("no gRPC server answers", absent.stderr)


if __name__ == "__main__":
    unittest.main()

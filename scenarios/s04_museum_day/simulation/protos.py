"""The gRPC code of Docent's API, made from proto/ by protoc. Needs python3-grpcio, protobuf-compiler and protobuf-compiler-grpc."""
import importlib
import pathlib
import subprocess
import sys

PROTO = pathlib.Path(__file__).resolve().parents[3] / "proto"
PLUGIN = "/usr/bin/grpc_python_plugin"


class Protos:
    def __init__(self, folder):
        folder = pathlib.Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        subprocess.run(["protoc", "-I", PROTO, f"--python_out={folder}", f"--grpc_python_out={folder}",
                        f"--plugin=protoc-gen-grpc_python={PLUGIN}", *sorted(PROTO.glob("docent/v1/*.proto"))], check=True)
        sys.path.insert(0, str(folder))
        self.adapter, self.adapter_grpc = self.of("robot_adapter")
        self.context, self.context_grpc = self.of("context")
        self.fleet, self.fleet_grpc = self.of("fleet")

    @staticmethod
    def of(name):
        return importlib.import_module(f"docent.v1.{name}_pb2"), importlib.import_module(f"docent.v1.{name}_pb2_grpc")

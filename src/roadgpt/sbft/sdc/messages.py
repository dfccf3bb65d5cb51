"""Defines the messages of the SDC testing competition's gRPC service; they are those of ``competition.proto``
in this folder.

The message classes are built from a table of their fields, and registered in a descriptor pool of their own.
Nothing needs to be compiled, and the classes do not conflict with compiled messages of the same names in the
same process.
"""

from typing import Any

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

FILE = "competition.proto"
SERVICE = "CompetitionTool"
Kind = descriptor_pb2.FieldDescriptorProto

MESSAGES: dict[str, tuple[tuple[str, int | str, bool], ...]] = {
    "Empty": (),
    "NameReply": (("name", Kind.TYPE_STRING, False),),
    "RoadPoint": (
        ("sequenceNumber", Kind.TYPE_INT64, False),
        ("x", Kind.TYPE_FLOAT, False),
        ("y", Kind.TYPE_FLOAT, False),
    ),
    "SDCTestCase": (("testId", Kind.TYPE_STRING, False), ("roadPoints", "RoadPoint", True)),
    "Oracle": (("testCase", "SDCTestCase", False), ("hasFailed", Kind.TYPE_BOOL, False)),
    "InitializationReply": (("ok", Kind.TYPE_BOOL, False),),
    "SelectionReply": (("testId", Kind.TYPE_STRING, False),),
    "PrioritizationReply": (("testId", Kind.TYPE_STRING, False),),
}
"""For each message, its fields in the order of their numbers: (name, scalar type or name of a message, is
repeated)."""

METHODS = {
    "Name": ("Empty", False, "NameReply", False),
    "Initialize": ("Oracle", True, "InitializationReply", False),
    "Select": ("SDCTestCase", True, "SelectionReply", True),
    "Prioritize": ("SDCTestCase", True, "PrioritizationReply", True),
}
"""For each RPC: (request, whether the request is a stream, reply, whether the reply is a stream)."""


def description() -> Any:
    """Returns ``competition.proto`` as a protobuf file descriptor."""
    file = descriptor_pb2.FileDescriptorProto(name=FILE, syntax="proto3")
    for name, fields in MESSAGES.items():
        message = file.message_type.add(name=name)
        for number, (field, kind, is_repeated) in enumerate(fields, 1):
            label = Kind.LABEL_REPEATED if is_repeated else Kind.LABEL_OPTIONAL
            made = message.field.add(name=field, number=number, label=label)
            if isinstance(kind, str):
                made.type, made.type_name = Kind.TYPE_MESSAGE, f".{kind}"
            else:
                made.type = kind
    service = file.service.add(name=SERVICE)
    for name, (request, takes_many, reply, gives_many) in METHODS.items():
        method = service.method.add(name=name, input_type=f".{request}", output_type=f".{reply}")
        if takes_many:
            method.client_streaming = True
        if gives_many:
            method.server_streaming = True
    return file


_POOL = descriptor_pool.DescriptorPool()
_POOL.AddSerializedFile(description().SerializeToString())


def message(name: str) -> Any:
    """Returns the class of the message with this name."""
    return message_factory.GetMessageClass(_POOL.FindMessageTypeByName(name))

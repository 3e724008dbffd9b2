"""A client of HTTP/2 that sends exactly what a test says: calls whose messages never end (RFC 9113). Nothing is compressed."""
import socket
import struct
import threading
import time

DATA, HEADERS, RST_STREAM, SETTINGS, PING, GOAWAY, WINDOW_UPDATE = 0, 1, 3, 4, 6, 7, 8
END_STREAM, END_HEADERS, ACK = 1, 4, 1


def frame(kind, flags, stream, payload):
    return struct.pack(">I", len(payload))[1:] + bytes([kind, flags]) + struct.pack(">I", stream) + payload


def field(name, value):
    """A literal header field, never indexed names, of fewer than 127 bytes each."""
    return b"\x00" + bytes([len(name)]) + name.encode() + bytes([len(value)]) + value.encode()


class Http2Client:
    """One connection. A thread reads what the server says and keeps the windows."""

    def __init__(self, address):
        host, port = address.rsplit(":", 1)
        self.socket = socket.create_connection((host, int(port)), timeout=60)
        self.socket.settimeout(None)
        self.changed = threading.Condition()
        self.writing = threading.Lock()
        self.windows, self.initial, self.largest = {0: 65535}, 65535, 16384
        self.ended, self.closed, self.next_stream = set(), False, 1
        self.write(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + frame(SETTINGS, 0, 0, b""))
        threading.Thread(target=self.read, daemon=True).start()

    def write(self, data):
        with self.writing:
            self.socket.sendall(data)

    def exactly(self, size):
        data = b""
        while len(data) < size:
            piece = self.socket.recv(size - len(data))
            if not piece:
                raise ConnectionError
            data += piece
        return data

    def read(self):
        try:
            while True:
                head = self.exactly(9)
                payload = self.exactly(int.from_bytes(head[:3], "big"))
                self.take(head[3], head[4], int.from_bytes(head[5:], "big") & 0x7FFFFFFF, payload)
        except OSError:
            with self.changed:
                self.closed = True
                self.changed.notify_all()

    def take(self, kind, flags, stream, payload):
        with self.changed:
            if kind == SETTINGS and not flags & ACK:
                for at in range(0, len(payload), 6):
                    name, value = struct.unpack(">HI", payload[at:at + 6])
                    if name == 4:
                        for one in self.windows:
                            self.windows[one] += value - self.initial if one else 0
                        self.initial = value
                    if name == 5:
                        self.largest = value
            elif kind == WINDOW_UPDATE:
                self.windows[stream] = self.windows.get(stream, self.initial) + (int.from_bytes(payload, "big") & 0x7FFFFFFF)
            elif kind == RST_STREAM or (kind in (DATA, HEADERS) and flags & END_STREAM):
                self.ended.add(stream)
            self.changed.notify_all()
        if kind == SETTINGS and not flags & ACK:
            self.write(frame(SETTINGS, ACK, 0, b""))
        elif kind == PING and not flags & ACK:
            self.write(frame(PING, ACK, 0, payload))

    def call(self, path):
        """Begins a gRPC call. The number of its stream."""
        with self.changed:
            stream = self.next_stream
            self.next_stream += 2
            self.windows[stream] = self.initial
        fields = [(":method", "POST"), (":scheme", "http"), (":path", path), (":authority", "localhost"),
                  ("content-type", "application/grpc"), ("te", "trailers")]
        self.write(frame(HEADERS, END_HEADERS, stream, b"".join(field(*one) for one in fields)))
        return stream

    def send(self, stream, data, patience_s):
        """As much of the data as the server lets in within the time; the number of bytes."""
        sent, until = 0, time.monotonic() + patience_s
        while sent < len(data):
            with self.changed:
                while not self.over(stream) and min(self.windows[0], self.windows[stream]) <= 0 and time.monotonic() < until:
                    self.changed.wait(0.05)
                size = min(len(data) - sent, self.windows[0], self.windows[stream], self.largest)
                if self.over(stream) or size <= 0:
                    return sent
                self.windows[0] -= size
                self.windows[stream] -= size
            try:
                self.write(frame(DATA, 0, stream, data[sent:sent + size]))
            except OSError:
                return sent
            sent += size
        return sent

    def over(self, stream):
        return self.closed or stream in self.ended

    def wait_over(self, stream, patience_s):
        """True when the server has ended the call."""
        with self.changed:
            return self.changed.wait_for(lambda: self.over(stream), patience_s)

    def close(self):
        try:
            self.socket.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass
        self.socket.close()

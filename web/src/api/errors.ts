// What went wrong with a call, in plain words: what happened, and what to do.
import { Code, ConnectError } from "@connectrpc/connect";

export interface PlainError {
  kind: "away" | "missing" | "unable" | "refused" | "cancelled" | "failed";
  title: string;
  detail: string;
}

const awayWords = "It is off, or the network is. This page goes on by itself when it is back.";

// "has 300 bytes; the limit name_bytes is 256" is "has 300 bytes; at most 256 are allowed".
export function limitWords(text: string): string {
  return text
    .replace(/; the limit (?:of an answer )?\w+_\w+ is ([\d,]+)/g, "; at most $1 are allowed")
    .replace(/\bthe limit \w+_\w+ = ([\d,]+)/g, "the limit of $1");
}

export function plain(error: unknown): PlainError {
  const e = ConnectError.from(error);
  const words = limitWords(e.rawMessage.replace(/[^\n]{400,}/g, (line) => `${line.slice(0, 400)}…`)); // a line of somebody's file may be in it
  switch (e.code) {
    case Code.Canceled:
      return { kind: "cancelled", title: "Cancelled", detail: "" };
    case Code.Unavailable:
      return {
        kind: "away",
        title: "The server does not answer",
        detail: `${awayWords} ${words.startsWith("HTTP") ? "" : words}`.trim(),
      };
    case Code.Unimplemented:
      return {
        kind: "unable",
        title: "This server can't do that yet",
        detail: "It is older than the app, or was built without this part.",
      };
    case Code.NotFound:
      return { kind: "missing", title: "It is not there", detail: words };
    case Code.InvalidArgument:
    case Code.FailedPrecondition:
    case Code.AlreadyExists:
    case Code.Aborted:
    case Code.OutOfRange:
      return { kind: "refused", title: "The server refuses it", detail: words };
    case Code.PermissionDenied:
    case Code.Unauthenticated:
      return { kind: "refused", title: "Not allowed", detail: words };
    case Code.ResourceExhausted:
      return { kind: "refused", title: "A limit is reached", detail: words };
    case Code.DeadlineExceeded:
      return {
        kind: "failed",
        title: "It takes too long",
        detail: "The server did not answer in time. Try again.",
      };
    default:
      if (e.cause instanceof TypeError || /fetch|network/i.test(words))
        return { kind: "away", title: "The server does not answer", detail: awayWords };
      return { kind: "failed", title: "Something went wrong", detail: words };
  }
}

export function sentence(error: unknown): string {
  const { title, detail } = plain(error);
  return detail ? `${title}. ${detail}` : `${title}.`;
}

// The open document: palette, canvas, properties and text, with one selection and one undo stack over all of them.
import { useEffect, useRef, useState } from "react";
import { Guard } from "../ui/guard";
import { DraftSync } from "./draft_sync";
import { EditorBody } from "./editor_body";
import { useEditorCommands } from "./editor_commands";
import { EditorDialogs } from "./editor_dialogs";
import { EditorHeader } from "./editor_header";
import type { LiveVersion } from "./load_document";
import { Session } from "./session";
import { textSetup } from "./text_setup";
import { type OpenDocument, useEditor } from "./use_editor";
import "./editor.css";

interface EditorProps extends Omit<OpenDocument, "session" | "sync"> {
  text: string;
  live: LiveVersion | null; // that the server runs
  base: string | null; // the deployed text that `text` began from
}

export function Editor(props: EditorProps) {
  const opened = useSession(props.name, props);
  return opened ? (
    <Guard>
      <Open key={props.name} {...props} {...opened} />
    </Guard>
  ) : null; // a view that stops keeps the session, and its undo with it
}

// The session lives as long as the document is open, and the keeping of its draft with it.
function useSession(
  name: string,
  begun: Pick<EditorProps, "text" | "live" | "base">,
): { session: Session; sync: DraftSync } | null {
  const [opened, setOpened] = useState<{ session: Session; sync: DraftSync } | null>(null);
  const first = useRef(begun);
  useEffect(() => {
    const session = new Session(first.current.text, textSetup);
    const sync = new DraftSync(name, session, first.current.live, first.current.base);
    setOpened({ session, sync });
    return () => {
      sync.close();
      first.current = { text: session.written, live: sync.live, base: sync.base };
      session.destroy();
    };
  }, [name]);
  return opened;
}

function Open(props: OpenDocument) {
  const editor = useEditor(props);
  useEditorCommands(editor);
  const { tab, palette, text } = editor.panels;
  return (
    <main className={`editor tab-${tab}${palette ? " with-palette" : ""}${text ? " with-text" : ""}`}>
      <EditorHeader editor={editor} />
      <EditorBody editor={editor} />
      <EditorDialogs editor={editor} />
    </main>
  );
}

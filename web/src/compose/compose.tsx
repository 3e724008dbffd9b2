// Compose: the canvas and the text of one workflow side by side.
import { ChevronRight, FileUp } from "lucide-react";
import { useEffect, useState } from "react";
import { Link } from "../ui/link";
import { paths } from "../ui/router";
import { templates } from "../cawl/templates";
import { saveDraft } from "../flow/drafts";
import { Editor } from "./editor";
import { loadDocument, type Loaded } from "./load_document";
import { openFile } from "./files";
import { TemplateCards } from "./template_cards";

export default function Compose(props: {
  name: string;
  flow: string;
  step: string;
  via: string;
  trial: string;
}) {
  const [loaded, setLoaded] = useState<Loaded | null>(null);
  useEffect(() => {
    let there = true;
    void loadDocument(props.name).then((result) => there && setLoaded(result));
    return () => void (there = false);
  }, [props.name]);
  if (!loaded) return <main className="view" aria-busy="true" />;
  if (loaded.text !== null)
    return (
      <Editor
        name={props.name}
        text={loaded.text}
        live={loaded.live}
        base={loaded.base}
        flow={props.flow}
        step={props.step}
        via={props.via}
        trial={props.trial}
      />
    );
  const begin = (text: string) => {
    saveDraft(props.name, text, "");
    setLoaded({ ...loaded, text, base: null });
  };
  return (
    <main className="view">
      <div className="wide" style={{ maxWidth: 860 }}>
        <p className="row faint small" style={{ gap: "var(--space-2)", marginBottom: "var(--space-5)" }}>
          <Link href={paths.documents()}>Workflows</Link>
          <ChevronRight size={12} />
          {props.name}
        </p>
        <h1>{loaded.hidden ? `${props.name} is deployed` : `How does ${props.name} begin?`}</h1>
        <p className="quiet" style={{ margin: "var(--space-3) 0 var(--space-9)" }}>
          {loaded.hidden
            ? "This server does not give the text of deployed workflows. Open its file, or begin again from a template."
            : "Take the template that is nearest. All of it can be changed."}
        </p>
        <TemplateCards templates={templates} onChoose={(template) => begin(template.text(props.name))} />
        <p style={{ marginTop: "var(--space-8)" }}>
          <button className="button" onClick={() => void openFile().then((file) => file && begin(file.text))}>
            <FileUp size={14} />
            Open a file
          </button>
        </p>
      </div>
    </main>
  );
}

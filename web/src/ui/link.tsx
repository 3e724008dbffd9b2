import type { AnchorHTMLAttributes } from "react";
import { navigate } from "./router";

// A link inside the app: an ordinary one for new tabs and copying, without a new load of the page for a click.
export function Link(props: AnchorHTMLAttributes<HTMLAnchorElement> & { href: string }) {
  return (
    <a
      {...props}
      onClick={(event) => {
        props.onClick?.(event);
        if (event.defaultPrevented || event.metaKey || event.ctrlKey || event.shiftKey || event.button !== 0)
          return;
        event.preventDefault();
        navigate(props.href);
      }}
    />
  );
}

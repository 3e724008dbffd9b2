import { StrictMode } from "react";
import { createRoot } from "react-dom/client";
import { startTheme } from "../ui/theme";
import "../ui/base.css";
import { Visit } from "./visit";

startTheme();
// Pages without TLS, other than of this machine, have no service workers: the page works, it is not kept.
if (import.meta.env.PROD)
  navigator.serviceWorker?.register("/visit_worker.js", { scope: "/visit" }).catch(() => undefined);
const place = document.getElementById("app");
if (place)
  createRoot(place).render(
    <StrictMode>
      <Visit />
    </StrictMode>,
  );

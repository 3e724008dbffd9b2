import { StrictMode } from "react";
import { createRoot } from "react-dom/client";
import { App } from "./app/app";
import { startKeys } from "./ui/commands";
import { startRouter } from "./ui/router";
import { startTheme } from "./ui/theme";
import "./ui/base.css";
import "./ui/parts.css";

startTheme();
startRouter();
startKeys();
const place = document.getElementById("app");
if (place)
  createRoot(place).render(
    <StrictMode>
      <App />
    </StrictMode>,
  );

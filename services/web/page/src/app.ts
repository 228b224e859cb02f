// The objects that the parts of the page share, and the interface of a view.
import { Api } from "./api";
import { Channels } from "./channels";
import { Connection } from "./connection";
import { Identity } from "./identity";
import { MapView } from "./map/map_view";
import { Rights } from "./rights";
import { Notices } from "./ui/notices";
import { Theme } from "./ui/theme";

export interface App {
  channels: Channels;
  api: Api;
  notices: Notices;
  rights: Rights;
  connection: Connection;
  identity: Identity;
  map: MapView;
  theme: Theme;
}

/** A view beside the map. */
export interface ViewPart {
  element: HTMLElement;
  /** Called when the view is opened or left. */
  shown?(visible: boolean): void;
}

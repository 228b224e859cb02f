// The map turned by quarter turns: the part of Leaflet's coordinates that depends on it.
import * as L from "leaflet";

/** Quarter turns, counter-clockwise; cos and sin are exact. */
export class Turn {
  private quarters = 0;

  /** Leaflet's simple plane, turned. */
  readonly crs = {
    ...(L.CRS.Simple as object),
    projection: {
      project: ({ lng, lat }: L.LatLng) => L.point(...this.ahead(lng, lat)),
      unproject: ({ x, y }: L.Point) => {
        const [lng, lat] = this.back(x, y);
        return L.latLng(lat, lng);
      },
    },
  };

  get quarter(): number {
    return this.quarters;
  }

  set quarter(quarters: number) {
    this.quarters = ((Math.round(quarters) % 4) + 4) % 4;
  }

  get cos(): number {
    return [1, 0, -1, 0][this.quarters];
  }

  get sin(): number {
    return [0, 1, 0, -1][this.quarters];
  }

  get angle_rad(): number {
    return (this.quarters * Math.PI) / 2;
  }

  /** Turns coordinates of the map frame: then x goes to the right and y up. */
  ahead(x: number, y: number): [number, number] {
    return [this.cos * x - this.sin * y, this.sin * x + this.cos * y];
  }

  /** Turns such coordinates back into the map frame. */
  back(x: number, y: number): [number, number] {
    return [this.cos * x + this.sin * y, this.cos * y - this.sin * x];
  }
}

//! The verdict as JSON: all figures.

use super::Verdict;
use crate::cli::settings::method_name;
use crate::curves::Place;
use crate::mesh::FacePlace;
use crate::quality::{Chain, Extremes, Feature, FeatureKind, Line, LineBreak, Ranked, Ring, Spot, Subject, Vertex};
use glam::DVec3;
use serde_json::{Value, json};

/// The whole of it; docs/QUALITY.md has the keys.
pub(super) fn json(verdict: &Verdict<'_>) -> serde_json::Result<Vec<u8>> {
    let limits = &verdict.limits;
    let mut rank = 0;
    let mut places = Vec::new();
    for ranked in &verdict.ranked {
        let is_ignored = verdict.is_ignored(ranked);
        rank += usize::from(!is_ignored);
        places.push(place(verdict, (!is_ignored).then_some(rank), ranked));
    }
    let over = verdict.over();
    let quality = verdict.quality;
    let unjudged = &quality.unjudged;
    let value = json!({
        "version": 1,
        "mesh": verdict.mesh.name,
        "made_by": verdict.made_by,
        "field": method_name(&verdict.field.method),
        "unit": if limits.mm_per_unit.is_some() { "mm" } else { "world" },
        "mm_per_unit": limits.mm_per_unit,
        "limits": { "gap": limits.gap, "angle_deg": limits.angle_deg, "curvature_percent": limits.percent },
        "weld": quality.weld * limits.gap_unit(),
        "ignored": verdict.ignored.iter().map(|kind| kind.name()).collect::<Vec<_>>(),
        "pass": verdict.passes(),
        "verdict": match verdict.passes() {
            Some(true) => "pass",
            Some(false) => "fail",
            None => "nothing to judge",
        },
        "judged": verdict.judged().count(),
        "over": over,
        "smooth_joints": joint(verdict, &verdict.quality.smooth, verdict.quality.smooth_joints),
        "unjudged": {
            "edges_without_surface": unjudged.edges_without_surface,
            "nonmanifold_edges": unjudged.nonmanifold_edges,
            "nonmanifold_vertices": unjudged.nonmanifold_vertices,
        },
        "unwelded_vertices": quality.unwelded.map(|unwelded| json!({
            "count": unwelded.count, "first": unwelded.first, "distance": unwelded.distance * limits.gap_unit(),
        })),
        "nearby_boundary": quality.nearby.map(|nearby| json!({
            "distance": nearby.distance * limits.gap_unit(), "at": at(nearby.place, nearby.position),
        })),
        "reversed_faces": faces(verdict, &verdict.orientation.reversed),
        "one_sided_components": faces(verdict, &verdict.orientation.one_sided),
        "without_area": verdict.without_area,
        "places": places,
    });
    let mut text = serde_json::to_vec_pretty(&value)?;
    text.push(b'\n');
    Ok(text)
}

fn at(place: Place, position: DVec3) -> Value {
    json!({ "face": place.face, "u": place.u, "v": place.v, "position": position.to_array() })
}

/// Some faces of the control mesh: how many, and the first as the file counts it.
fn faces(verdict: &Verdict<'_>, faces: &[u32]) -> Value {
    let first = faces.first().map(|&face| {
        let FacePlace { face, line, prim } = verdict.mesh.face_place(face);
        json!({ "face": face, "line": line, "prim": prim })
    });
    json!({ "count": faces.len(), "first": first })
}

fn joint(verdict: &Verdict<'_>, extremes: &Extremes, joints: usize) -> Value {
    let Extremes { samples, undefined, gap, angle_deg, difference, concave, line, .. } = *extremes;
    json!({
        "joints": joints,
        "samples": samples,
        "without_tangent_plane": undefined,
        "gap": gap * verdict.limits.gap_unit(),
        "angle_deg": angle_deg,
        "curvature_percent": difference.map(|difference| 100.0 * difference),
        "concave": concave,
        "line": line.map(|line| line_break(&line)),
    })
}

fn line_break(line: &LineBreak) -> Value {
    json!({ "jump": line.jump, "jump_lines": line.lines, "along": line.along, "turn_deg": line.turn_deg })
}

fn place(verdict: &Verdict<'_>, rank: Option<usize>, ranked: &Ranked<'_>) -> Value {
    let mut value = match ranked.subject {
        Subject::Feature(feature) => of_feature(verdict, feature),
        Subject::Vertex(vertex) => of_vertex(verdict, vertex),
    };
    // JSON has no infinity: null, where there is no tangent plane.
    let finite = |x: f64| x.is_finite().then_some(x);
    let [gap, angle, curvature] = ranked.ratios.map(|(_, ratio)| finite(ratio));
    let (worst, severity) = ranked.worst();
    value["rank"] = json!(rank);
    value["kind"] = json!(ranked.kind().name());
    value["over"] = json!(ranked.is_over());
    value["worst"] = json!(worst.name());
    value["severity"] = json!(finite(severity));
    value["times_limit"] = json!({ "gap": gap, "angle": angle, "curvature": curvature });
    value["at"] = json!(ranked.spot().map(|(place, position)| at(place, position)));
    let prim = ranked.spot().and_then(|(place, _)| verdict.parts.name(place.face));
    if let Some(prim) = prim {
        value["prim"] = json!(prim);
    }
    value
}

fn of_feature(verdict: &Verdict<'_>, feature: &Feature) -> Value {
    let mut value = joint(verdict, &feature.extremes, feature.pieces.len());
    let chain = feature.chain.as_ref();
    value["vertices"] = json!(chain.map(|chain| &chain.vertices));
    let (what, number) = match feature.line {
        Line::Edge(edge) => ("edge", json!(edge)),
        Line::Spoke { face, corner } => ("spoke", json!({ "face": face, "corner": corner })),
        Line::Inside { ptex } => ("inside_ptex_face", json!(ptex)),
    };
    value["lies_on"] = json!({ what: number });
    value["closed"] = json!(chain.map(|chain| chain.closed));
    if feature.kind == FeatureKind::Seam {
        let chain = |chain: &Chain| json!({ "vertices": chain.vertices, "closed": chain.closed });
        value["beside"] = json!(feature.beside.iter().map(chain).collect::<Vec<_>>());
        value["reversed"] = json!(feature.reversed);
    }
    value["sharpness"] = json!(feature.sharpness);
    value["curvatures"] = json!(feature.extremes.worst.and_then(|(_, worst)| worst.continuity.curvature));
    // Flat: an infinite radius, which JSON has not.
    value["radius"] =
        json!(feature.radius.filter(|radius| radius.is_finite()).map(|radius| radius * verdict.limits.gap_unit()));
    value
}

fn of_vertex(verdict: &Verdict<'_>, vertex: &Vertex) -> Value {
    let (what, number) = match vertex.spot {
        Spot::Vertex(number) => ("vertex", json!(number)),
        Spot::Centre(face) => ("centre_of_face", json!(face)),
        Spot::Middle(edge) => ("middle_of_edge", json!(edge)),
        Spot::Inside(ptex) => ("inside_ptex_face", json!(ptex)),
    };
    let ring = |ring: &Ring| {
        json!({
            "radius": ring.radius, "distance": ring.distance, "principal_curvatures": ring.principal,
            "spread_percent": 100.0 * ring.spread, "turn_deg": ring.turn_deg,
        })
    };
    json!({
        "spot": { what: number },
        "rule": vertex.kind.name(),
        "faces": vertex.faces,
        "tangent_plane": vertex.tangent_plane,
        "gap": vertex.gap * verdict.limits.gap_unit(),
        "angle_deg": vertex.angle_deg,
        "curvature_percent": vertex.difference().map(|difference| 100.0 * difference),
        "growth": vertex.growth,
        "rings": vertex.rings.iter().map(ring).collect::<Vec<_>>(),
    })
}

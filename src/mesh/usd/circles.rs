//! Arcs that go in a circle: a prim that is composed of itself.
//!
//! Edges lead from a prim to what it inherits from, specializes or refers to. In one graph they also lead from every prim to those
//! below it, which come along: an arc within a circle makes prims below prims without end. In the other they lead from every prim to
//! its parent, as openusd 0.8 looks for what is inherited: an inheritance within a circle makes it call itself without end.

use openusd::ar::{DefaultResolver, ResolvedPath, Resolver};
use openusd::sdf::{AbstractData, Path, Value};
use std::collections::HashMap;

use super::open::DEEPEST;

/// Most prims that are followed through the arcs of those above them, beside ten for each that arcs name.
const MOST_FOLLOWED: usize = 100_000;

/// A prim of a layer; the root layer and its sublayers are one, number 0.
type Place = (usize, Path);

struct Arc {
    from: Place,
    /// The root stands for the layer's default prim.
    to: Place,
    inherits: bool,
}

/// The arcs of some layers.
#[derive(Default)]
pub(super) struct Arcs {
    arcs: Vec<Arc>,
    /// By where they are.
    layers: HashMap<String, usize>,
    default_prims: HashMap<usize, Path>,
    resolver: DefaultResolver,
}

impl Arcs {
    /// Says that a layer is the root layer, or one of its sublayers.
    pub(super) fn root(&mut self, location: &str) {
        self.layers.insert(location.to_owned(), 0);
    }

    /// The number of the layer at a place.
    fn layer(&mut self, location: &str) -> usize {
        let next = self.layers.len() + 1;
        *self.layers.entry(location.to_owned()).or_insert(next)
    }

    /// Adds the arcs of the layer at a place.
    pub(super) fn add(&mut self, location: &str, data: &dyn AbstractData) {
        let layer = self.layer(location);
        if let Ok(Some(name)) = data.try_field(&Path::abs_root(), "defaultPrim")
            && let Value::Token(name) = &*name
            && let Ok(prim) = Path::abs_root().append_path(name.as_str())
        {
            self.default_prims.entry(layer).or_insert(prim);
        }
        for path in data.spec_paths().into_iter().filter(|path| !path.is_property_path()) {
            let from = path.strip_all_variant_selections();
            for (field, inherits) in
                [("inheritPaths", true), ("specializes", true), ("references", false), ("payload", false)]
            {
                let Ok(Some(value)) = data.try_field(&path, field) else { continue };
                for (asset, target) in targets(&value) {
                    let Some(to) = self.target(layer, location, &asset) else { continue };
                    let prim = if target.is_empty() { Path::abs_root() } else { from.make_absolute(&target) };
                    let to = (to, prim.strip_all_variant_selections());
                    self.arcs.push(Arc { from: (layer, from.clone()), to, inherits });
                }
            }
        }
    }

    /// The layer that an arc leads to; `None` where there is none.
    fn target(&mut self, layer: usize, location: &str, asset: &str) -> Option<usize> {
        if asset.is_empty() {
            return Some(layer);
        }
        let identifier = self.resolver.create_identifier(asset, Some(&ResolvedPath::new(location)));
        let found = self.resolver.resolve(&identifier)?;
        Some(self.layer(&found.to_string_lossy()))
    }

    /// A prim that an arc leads back to.
    pub(super) fn circle(&self) -> Option<&Path> {
        self.within_circle(true, |_| true).or_else(|| self.within_circle(false, |arc| arc.inherits))
    }

    /// Where one of these arcs starts that is within a circle: with edges down from each prim in its own layer, or with edges up, all
    /// layers one.
    fn within_circle(&self, down: bool, counts: impl Fn(&Arc) -> bool) -> Option<&Path> {
        let place = |(layer, path): &Place| {
            let path = if path.is_abs_root() { self.default_prims.get(layer)? } else { path };
            Some((if down { *layer } else { 0 }, path.clone()))
        };
        let ends = self.arcs.iter().map(|arc| Some((arc, [place(&arc.from)?, place(&arc.to)?])));
        let ends: Vec<_> = ends.flatten().collect();
        let mut graph = Graph { down, ..Graph::default() };
        let mut arcs: HashMap<&Place, Vec<&Place>> = HashMap::new();
        let mut nodes = Vec::new();
        for (_, [from, to]) in &ends {
            arcs.entry(from).or_default().push(to);
            nodes.push([graph.node(from), graph.node(to)]);
        }
        graph.edges.extend(&nodes);
        graph.follow(&arcs);
        let component = graph.components();
        let mut closed = ends.iter().zip(&nodes).filter(|(_, [from, to])| component[*from] == component[*to]);
        closed.find(|((arc, _), _)| counts(arc)).map(|((arc, _), _)| &arc.from.1)
    }
}

#[derive(Default)]
struct Graph {
    places: Vec<Place>,
    nodes: HashMap<Place, usize>,
    edges: Vec<[usize; 2]>,
    /// Whether edges lead from prims to those below them, or the other way.
    down: bool,
}

impl Graph {
    fn insert(&mut self, place: Place) -> usize {
        let node = self.places.len();
        self.places.push(place.clone());
        self.nodes.insert(place, node);
        node
    }

    /// The node of a prim; a new one is joined to its parent.
    fn node(&mut self, place: &Place) -> usize {
        if let Some(&node) = self.nodes.get(place) {
            return node;
        }
        let first = self.insert(place.clone());
        let (mut node, mut parent) = (first, place.1.parent());
        while let Some(path) = parent.filter(|path| !path.is_abs_root()) {
            parent = path.parent();
            let above = (place.0, path);
            let known = self.nodes.get(&above).copied();
            let above = known.unwrap_or_else(|| self.insert(above));
            self.edges.push(if self.down { [above, node] } else { [node, above] });
            if known.is_some() {
                break;
            }
            node = above;
        }
        first
    }

    /// Adds what arcs of prims above bring: where `/a` refers to `/b`, `/a/c` is made of `/b/c`.
    fn follow(&mut self, arcs: &HashMap<&Place, Vec<&Place>>) {
        // Prims that grow without end are a circle, which the first of them shows.
        let most = MOST_FOLLOWED + 10 * self.places.len();
        let mut next = 0;
        while next < self.places.len().min(most) {
            let (layer, path) = self.places[next].clone();
            for above in path.strict_ancestors_below_root() {
                let above = (layer, above);
                for to in arcs.get(&above).into_iter().flatten() {
                    if let Some(prim) = path.replace_prefix(&above.1, &to.1).filter(|p| p.element_count() <= DEEPEST) {
                        let node = self.node(&(to.0, prim));
                        self.edges.push([next, node]);
                    }
                }
            }
            next += 1;
        }
    }

    /// For each node a number, which those have in common that lead to one another (Kosaraju's algorithm, without recursion).
    fn components(&self) -> Vec<usize> {
        const NONE: usize = usize::MAX;
        let count = self.places.len();
        let (mut out, mut back) = (vec![Vec::new(); count], vec![Vec::new(); count]);
        for &[from, to] in &self.edges {
            out[from].push(to);
            back[to].push(from);
        }
        // Each after all that it leads to.
        let mut order = Vec::with_capacity(count);
        let mut seen = vec![false; count];
        for start in 0..count {
            let mut path = vec![(start, 0)];
            while let Some((node, next)) = path.pop() {
                if next == 0 && std::mem::replace(&mut seen[node], true) {
                    continue;
                }
                match out[node].get(next) {
                    Some(&to) => path.extend([(node, next + 1), (to, 0)]),
                    None => order.push(node),
                }
            }
        }
        let mut component = vec![NONE; count];
        for &start in order.iter().rev() {
            let mut open = vec![start];
            while let Some(node) = open.pop() {
                if component[node] == NONE {
                    component[node] = start;
                    open.extend(&back[node]);
                }
            }
        }
        component
    }
}

/// The files and prims that the value of an arc leads to; without a file it is the same layer, without a prim the default one.
fn targets(value: &Value) -> Vec<(String, Path)> {
    match value {
        Value::PathListOp(list) => list.flatten().into_iter().map(|path| (String::new(), path)).collect(),
        Value::ReferenceListOp(list) => list.flatten().into_iter().map(|arc| (arc.asset_path, arc.prim_path)).collect(),
        Value::PayloadListOp(list) => list.flatten().into_iter().map(|arc| (arc.asset_path, arc.prim_path)).collect(),
        Value::Payload(arc) => vec![(arc.asset_path.clone(), arc.prim_path.clone())],
        _ => Vec::new(),
    }
}

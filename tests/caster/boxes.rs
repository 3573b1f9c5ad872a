//! A hierarchy of boxes: which pieces a ray may meet, the nearest first.

use super::Cast;
use super::bezier::Search;
use glam::DVec3;

/// Items in a leaf.
const LEAF: usize = 2;

#[derive(Debug, Clone, Copy)]
struct Node {
    centre: DVec3,
    half: DVec3,
    /// First item and their number in a leaf; else the second child (the first one follows) and 0.
    first: u32,
    count: u32,
}

/// The hierarchy, nodes in depth-first order.
#[derive(Debug, Default)]
pub struct Boxes {
    nodes: Vec<Node>,
    items: Vec<u32>,
}

impl Boxes {
    /// Over items with these bounds.
    pub fn new(bounds: &[[DVec3; 2]]) -> Boxes {
        let mut boxes = Boxes { nodes: Vec::new(), items: (0..bounds.len() as u32).collect() };
        if !bounds.is_empty() {
            boxes.build(bounds, 0, bounds.len());
        }
        boxes
    }

    fn build(&mut self, bounds: &[[DVec3; 2]], from: usize, to: usize) {
        let range = &mut self.items[from..to];
        let own = |&item: &u32| bounds[item as usize];
        let [low, high] = range.iter().map(own).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).expect("not empty");
        let (centre, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let node = self.nodes.len();
        self.nodes.push(Node { centre, half, first: from as u32, count: (to - from) as u32 });
        if to - from <= LEAF {
            return;
        }
        let axis = (0..3).max_by(|&a, &b| half[a].total_cmp(&half[b])).expect("three axes");
        let middle = range.len() / 2;
        let place = |item: &u32| own(item)[0][axis] + own(item)[1][axis];
        range.select_nth_unstable_by(middle, |a, b| place(a).total_cmp(&place(b)));
        self.build(bounds, from, from + middle);
        self.nodes[node].first = self.nodes.len() as u32;
        self.nodes[node].count = 0;
        self.build(bounds, from + middle, to);
    }

    /// Calls `visit` for the items whose boxes the ray meets where `search` still looks, roughly from near to far.
    pub fn walk(&self, cast: &Cast, search: &mut Search, mut visit: impl FnMut(usize, &mut Search)) {
        let Some(root) = self.nodes.first() else { return };
        // A line misses a box exactly if it does so in the projection along one of these (separating axes).
        let along = cast.frame.z_axis;
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| along.cross(axis));
        let depth = |node: &Node| {
            let d = node.centre - cast.origin;
            let misses = |axis: &DVec3| axis.dot(d).abs() > axis.abs().dot(node.half) + cast.rounding;
            let (middle, reach) = (along.dot(d), along.abs().dot(node.half) + cast.rounding);
            (!axes.iter().any(misses)).then_some([middle - reach, middle + reach])
        };
        let mut stack = vec![(0, depth(root))];
        while let Some((index, range)) = stack.pop() {
            let Some([near, far]) = range else { continue };
            if !search.looks_at(near, far) {
                continue;
            }
            let node = &self.nodes[index];
            if node.count > 0 {
                let items = node.first as usize..(node.first + node.count) as usize;
                self.items[items].iter().for_each(|&item| visit(item as usize, search));
                continue;
            }
            let mut children = [index + 1, node.first as usize].map(|child| (child, depth(&self.nodes[child])));
            let near = |range: Option<[f64; 2]>| range.map_or(f64::INFINITY, |[near, _]| near);
            children.sort_by(|a, b| near(b.1).total_cmp(&near(a.1)));
            stack.extend(children);
        }
    }
}

// The rows of the tile that the surface textures hold at a time.
struct Band {
    first: i32,
    rows: i32,
    padding: vec2i,
}

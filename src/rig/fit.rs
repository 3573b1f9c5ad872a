//! Rigs that suit an object.

use super::{Attachment, CameraRig, Colours, LightRig, PatternRig, ProjectionName, Rig, RigError, check_lines};
use crate::field::{Camera, DEFAULT_FOV, Field, Light, Method, Palette, Pattern, Projection, Scout};
use glam::{DMat3, DVec3};

/// Side of a picture where none is given, pixels.
const DEFAULT_SIDE: u32 = 1024;

/// A rig with nothing left open, but for the pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedRig {
    /// From where the picture is taken.
    pub camera: Camera,
    /// What is read off the surface.
    pub method: Method,
    /// The light that it is read by.
    pub light: PlacedLight,
    /// Colours.
    pub palette: Palette,
}

/// A light as rigs give it: the same vectors make the same light, to the last digit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedLight {
    /// Which coordinates the vectors are in.
    pub attached: Attachment,
    /// Point with coordinates (0, 0).
    pub center: DVec3,
    /// Normal of the plane; not zero.
    pub normal: DVec3,
    /// Direction of the lines; its part in the plane counts.
    pub lines: DVec3,
    /// Distance from one line to the next in units of the field.
    pub spacing: f64,
    /// Half the width and half the length; infinite where the light has no edge.
    pub half: [f64; 2],
}

/// From the camera's coordinates ([`Attachment::Camera`]) to world space, directions.
fn frame(camera: &Camera) -> DMat3 {
    let axes = camera.axes();
    DMat3::from_cols(axes.right, axes.up, -axes.forward)
}

impl PlacedLight {
    /// A light in world space, in the coordinates of what it is attached to.
    pub fn new(light: &Light, attached: Attachment, camera: &Camera) -> PlacedLight {
        let Light { center, axes, half, spacing } = *light;
        let (center, normal, lines) = match attached {
            Attachment::Object => (center, light.normal(), axes[1]),
            Attachment::Camera => {
                let inverse = frame(camera).transpose();
                (inverse * (center - camera.eye), inverse * light.normal(), inverse * axes[1])
            }
        };
        PlacedLight { attached, center, normal, lines, spacing, half }
    }

    /// The light in the coordinates of what it is attached to.
    pub fn own(&self) -> Light {
        Light { half: self.half, ..Light::new(self.center, self.normal, self.lines, self.spacing) }
    }

    /// The light in world space, before this camera.
    pub fn in_world(&self, camera: &Camera) -> Light {
        let own = self.own();
        match self.attached {
            Attachment::Object => own,
            Attachment::Camera => {
                let frame = frame(camera);
                Light { center: camera.eye + frame * own.center, axes: own.axes.map(|axis| frame * axis), ..own }
            }
        }
    }
}

impl FittedRig {
    /// Method and light, in world space.
    pub fn field(&self) -> Field {
        Field { light: self.light.in_world(&self.camera), method: self.method.clone() }
    }

    /// As a rig that says all of it.
    pub fn to_rig(&self, pattern: PatternRig) -> Rig {
        let Camera { eye, target, up, projection, size } = self.camera;
        let (projection, fov, height) = match projection {
            Projection::Perspective { fov } => (ProjectionName::Perspective, Some(fov), None),
            Projection::Orthographic { height } => (ProjectionName::Orthographic, None, Some(height)),
        };
        let PlacedLight { attached, center, normal, lines, spacing, half } = self.light;
        let has_ends = half.iter().all(|half| half.is_finite());
        Rig {
            preset: None,
            field: Some(self.method.clone()),
            camera: CameraRig {
                eye: Some(eye),
                target: Some(target),
                up: Some(up),
                projection: Some(projection),
                fov,
                height,
                size: Some(size),
            },
            light: LightRig {
                attached: Some(attached),
                center: Some(center),
                normal: Some(normal),
                lines: Some(lines),
                spacing: Some(spacing),
                size: has_ends.then(|| half.map(|half| 2.0 * half)),
            },
            pattern,
            colours: Colours::of(self.palette),
        }
    }
}

impl Rig {
    /// What is read off the surface: mirrored light, where nothing else is said.
    pub fn method(&self) -> Method {
        let of_preset = self.preset.map(|preset| preset.method());
        self.field.clone().or(of_preset).unwrap_or(Method::Reflection)
    }

    /// With what its preset says of every object. A light of another field than the preset's is not its own.
    pub fn with_preset(self) -> Rig {
        let Some(preset) = self.preset else { return self };
        let mut base = preset.rig();
        if self.method() != preset.method() {
            base.light = LightRig::default();
        }
        self.over(base)
    }

    /// With this direction up where the rig names none: that of the mesh.
    #[must_use]
    pub fn or_up(&self, up: Option<DVec3>) -> Rig {
        let camera = CameraRig { up: self.camera.up.or(up), ..self.camera.clone() };
        Rig { camera, ..self.clone() }
    }

    /// The rig for a surface, fitted where it leaves something open. `habit`: direction from the object to the eye, and
    /// light for reflections, that are used instead of fitted ones where the rig and its preset have none.
    ///
    /// # Errors
    /// As [`Rig::check`]; lines of light that turn out parallel to the normal are another.
    pub fn fit(&self, scout: &Scout, habit: Option<(DVec3, Light)>) -> Result<FittedRig, RigError> {
        let rig = self.clone().with_preset();
        rig.check()?;
        let habit = habit.filter(|_| rig.camera.up.is_none());
        let camera = rig.camera.fit(scout, habit.map(|(direction, _)| direction));
        let method = rig.method();
        let of_preset = rig.preset.filter(|preset| preset.method() == method);
        let of_preset = of_preset.and_then(|preset| preset.light(scout, &camera));
        let light = of_preset.or_else(|| habit.map(|(_, light)| light).filter(|_| method == Method::Reflection));
        let Field { light, method } = match light {
            Some(light) => Field { light, method },
            None => scout.field(&method, &camera),
        };
        let light = rig.light.place(&light, &camera)?;
        Ok(FittedRig { camera, method, light, palette: rig.colours.palette() })
    }
}

impl CameraRig {
    /// The camera, which looks against `direction` where nothing else is said, by default in three-quarter view.
    fn fit(&self, scout: &Scout, direction: Option<DVec3>) -> Camera {
        let size = self.size.unwrap_or([DEFAULT_SIDE; 2]);
        let up = self.up.unwrap_or(DVec3::Z);
        let direction = direction.unwrap_or_else(|| {
            let usual = scout.camera(size, up);
            usual.eye - usual.target
        });
        let orthographic = self.projection == Some(ProjectionName::Orthographic);
        let mut camera = match orthographic {
            true => scout.orthographic_from(size, up, direction),
            false => scout.camera_from(size, up, direction, self.fov.unwrap_or(DEFAULT_FOV)),
        };
        if let Some(target) = self.target {
            camera.eye += target - camera.target;
            camera.target = target;
        }
        camera.eye = self.eye.unwrap_or(camera.eye);
        if orthographic {
            let height = self.height.unwrap_or_else(|| scout.height_for(&camera));
            camera.projection = Projection::Orthographic { height };
        }
        camera
    }
}

impl LightRig {
    /// The light, which is `fitted` (in world space) where nothing else is said.
    fn place(&self, fitted: &Light, camera: &Camera) -> Result<PlacedLight, RigError> {
        let fitted = PlacedLight::new(fitted, self.attached.unwrap_or_default(), camera);
        let light = PlacedLight {
            center: self.center.unwrap_or(fitted.center),
            normal: self.normal.unwrap_or(fitted.normal),
            lines: self.lines.unwrap_or(fitted.lines),
            spacing: self.spacing.unwrap_or(fitted.spacing),
            half: self.size.map_or(fitted.half, |size| size.map(|side| side / 2.0)),
            ..fitted
        };
        // A fitted direction that happens to be parallel gives way to any other one.
        if self.lines.is_some() {
            check_lines(light.normal, light.lines)?;
        }
        Ok(light)
    }
}

impl PatternRig {
    /// The pattern, as [`read`](PatternRig::read) or with the ends that suit what the camera sees.
    pub fn fitted(pattern: Option<Pattern>, scout: &Scout, rig: &FittedRig) -> Pattern {
        pattern.unwrap_or_else(|| Pattern::Heat { range: scout.range(&rig.field(), &rig.camera) })
    }
}

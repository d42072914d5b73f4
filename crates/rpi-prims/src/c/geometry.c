/*# rpi_dot */
static inline double rpi_dot(const double *a, const double *b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
/*# rpi_norm */
static inline double rpi_norm(const double *v) {
  return rpi_sqrt(rpi_dot(v, v));
}
/*# rpi_cross */
static inline void rpi_cross(const double *a, const double *b, double *out) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}
/*# rpi_sum */
static inline void rpi_sum(const double *a, const double *b, int32_t count, double *out) {
  int32_t k;
  for (k = 0; k < count; k += 1) {
    out[k] = a[k] + b[k];
  }
}
/*# rpi_difference */
static inline void rpi_difference(const double *a, const double *b, int32_t count, double *out) {
  int32_t k;
  for (k = 0; k < count; k += 1) {
    out[k] = a[k] - b[k];
  }
}
/*# rpi_negation */
static inline void rpi_negation(const double *a, int32_t count, double *out) {
  int32_t k;
  for (k = 0; k < count; k += 1) {
    out[k] = -a[k];
  }
}
/*# rpi_scaled */
static inline void rpi_scaled(const double *a, double factor, int32_t count, double *out) {
  int32_t k;
  for (k = 0; k < count; k += 1) {
    out[k] = a[k] * factor;
  }
}
/*# rpi_divided */
static inline void rpi_divided(const double *a, double divisor, int32_t count, double *out) {
  int32_t k;
  for (k = 0; k < count; k += 1) {
    out[k] = a[k] / divisor;
  }
}
/*# rpi_add_scaled */
static inline void rpi_add_scaled(const double *a, const double *b, double factor, int32_t count, double *out) {
  int32_t k;
  for (k = 0; k < count; k += 1) {
    out[k] = a[k] + b[k] * factor;
  }
}
/*# rpi_equal */
static inline bool rpi_equal(const double *a, const double *b, int32_t count) {
  int32_t k;
  for (k = 0; k < count; k += 1) {
    if (!(a[k] == b[k])) {
      return false;
    }
  }
  return true;
}
/*# rpi_same_rotation */
/* The quaternions q and -q are one rotation. */
static inline bool rpi_same_rotation(const double *a, const double *b) {
  double negative[4];
  rpi_negation(b, 4, negative);
  return rpi_equal(a, b, 4) || rpi_equal(a, negative, 4);
}
/*# rpi_inverse */
/* Inverse of a rotation: the conjugate quaternion. */
static inline void rpi_inverse(const double *q, double *out) {
  out[0] = -q[0];
  out[1] = -q[1];
  out[2] = -q[2];
  out[3] = q[3];
}
/*# rpi_compose */
/* Product of two quaternions (x, y, z, w). `out` may be an operand. */
static inline void rpi_compose(const double *a, const double *b, double *out) {
  const double w = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
  const double x = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1];
  const double y = a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0];
  const double z = a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3];
  out[0] = x;
  out[1] = y;
  out[2] = z;
  out[3] = w;
}
/*# rpi_rotate */
/* Vector v rotated by the quaternion q. `out` may be `v`. */
static inline void rpi_rotate(const double *q, const double *v, double *out) {
  double t[3];
  double c[3];
  int32_t k;
  rpi_cross(q, v, t);
  for (k = 0; k < 3; k += 1) {
    t[k] = t[k] * 2.0;
  }
  rpi_cross(q, t, c);
  for (k = 0; k < 3; k += 1) {
    out[k] = t[k] * q[3] + c[k] + v[k];
  }
}
/*# rpi_from_axis */
/* Rotation about the direction of a vector by its length in rad. */
static void rpi_from_axis(const double *v, double *out) {
  const double angle = rpi_norm(v);
  const double s = rpi_sin(angle / 2.0);
  int32_t k;
  for (k = 0; k < 3; k += 1) {
    out[k] = (angle > 0.0 ? v[k] / angle : v[k]) * s;
  }
  out[3] = rpi_cos(angle / 2.0);
}
/*# rpi_to_axis */
/* Unit axis and angle (rad, 0 to pi) of a rotation. The axis is x for the identity. */
static double rpi_to_axis(const double *q, double *axis) {
  const double sign = q[3] < 0.0 ? -1.0 : 1.0;
  double v[3];
  double s;
  int32_t k;
  for (k = 0; k < 3; k += 1) {
    v[k] = q[k] * sign;
  }
  s = rpi_norm(v);
  if (s == 0.0) {
    axis[0] = 1.0;
    axis[1] = 0.0;
    axis[2] = 0.0;
    return 0.0;
  }
  for (k = 0; k < 3; k += 1) {
    axis[k] = v[k] / s;
  }
  return 2.0 * rpi_atan2(s, q[3] * sign);
}
/*# rpi_to_rotation_vector */
/* Axis times angle (rad) of a rotation. */
static void rpi_to_rotation_vector(const double *q, double *out) {
  double axis[3];
  const double angle = rpi_to_axis(q, axis);
  rpi_scaled(axis, angle, 3, out);
}
/*# rpi_interpolate_rotation */
/* Rotation on the shortest arc, a for amount 0 and b for amount 1. `out` may be an operand. */
static void rpi_interpolate_rotation(const double *a, const double *b, double amount, double *out) {
  double q[4];
  double v[3];
  rpi_inverse(a, q);
  rpi_compose(q, b, q);
  rpi_to_rotation_vector(q, v);
  rpi_scaled(v, amount, 3, v);
  rpi_from_axis(v, q);
  rpi_compose(a, q, out);
}
/*# rpi_from_abc */
/* Rotation by a about z, then by b about the new y, then by c about the new x, in rad. */
static void rpi_from_abc(double a, double b, double c, double *out) {
  const double sa = rpi_sin(a / 2.0);
  const double ca = rpi_cos(a / 2.0);
  const double sb = rpi_sin(b / 2.0);
  const double cb = rpi_cos(b / 2.0);
  const double sc = rpi_sin(c / 2.0);
  const double cc = rpi_cos(c / 2.0);
  out[0] = ca * cb * sc - sa * sb * cc;
  out[1] = ca * sb * cc + sa * cb * sc;
  out[2] = sa * cb * cc - ca * sb * sc;
  out[3] = ca * cb * cc + sa * sb * sc;
}
/*# rpi_to_abc */
/* Angles of rpi_from_abc. Within 1e-12 of the gimbal lock, c is 0. */
static void rpi_to_abc(const double *q, double *abc) {
  const double x = q[0];
  const double y = q[1];
  const double z = q[2];
  const double w = q[3];
  const double ww = w * w;
  const double xx = x * x;
  const double yy = y * y;
  const double zz = z * z;
  const double xy = x * y * 2.0;
  const double wz = w * z * 2.0;
  const double wy = w * y * 2.0;
  const double xz = x * z * 2.0;
  const double yz = y * z * 2.0;
  const double wx = w * x * 2.0;
  const double m00 = ww + xx - yy - zz;
  const double m10 = wz + xy;
  abc[1] = rpi_atan2(-(xz - wy), rpi_sqrt(m00 * m00 + m10 * m10));
  if (rpi_abs(abc[1]) > 1.57079632679489661923 - 1e-12) {
    abc[0] = rpi_atan2(-(xy - wz), ww - xx + yy - zz);
    abc[2] = 0.0;
  } else {
    abc[0] = rpi_atan2(m10, m00);
    abc[2] = rpi_atan2(wx + yz, ww - xx - yy + zz);
  }
}
/*# rpi_from_quaternion */
/* Normalised quaternion; the identity for the zero quaternion. */
static void rpi_from_quaternion(double x, double y, double z, double w, double *out) {
  const double length = rpi_sqrt(x * x + y * y + z * z + w * w);
  out[0] = 0.0;
  out[1] = 0.0;
  out[2] = 0.0;
  out[3] = 1.0;
  if (length > 0.0) {
    out[0] = x / length;
    out[1] = y / length;
    out[2] = z / length;
    out[3] = w / length;
  }
}
/*# rpi_pose_inverse */
static void rpi_pose_inverse(const double *p, double *out) {
  double shift[3];
  rpi_inverse(p + 3, out + 3);
  rpi_negation(p, 3, shift);
  rpi_rotate(out + 3, shift, out);
}
/*# rpi_pose_compose */
static void rpi_pose_compose(const double *a, const double *b, double *out) {
  double shift[3];
  rpi_rotate(a + 3, b, shift);
  rpi_compose(a + 3, b + 3, out + 3);
  rpi_sum(a, shift, 3, out);
}
/*# rpi_integrate_pose */
/* Pose after `dt` seconds of motion with the constant velocity `twist` in base coordinates. */
static void rpi_integrate_pose(const double *pose, const double *twist, double dt, double *out) {
  double turn[3];
  double rotation[4];
  rpi_add_scaled(pose, twist, dt, 3, out);
  rpi_scaled(twist + 3, dt, 3, turn);
  rpi_from_axis(turn, rotation);
  rpi_compose(rotation, pose + 3, out + 3);
}
/*# rpi_share_within */
/* Largest factor, at most 1, that scales `size` to `bound` or less. */
static inline double rpi_share_within(double size, double bound) {
  return size > bound ? bound / size : 1.0;
}
/*# rpi_least */
/* The smaller of two reals that are not NaN together; a NaN loses. */
static inline double rpi_least(double a, double b) {
  return rpi_is_nan(a) || b < a ? b : a;
}
/*# rpi_greatest */
static inline double rpi_greatest(double a, double b) {
  return rpi_is_nan(a) || b > a ? b : a;
}
/*# rpi_travel_time */
static inline double rpi_travel_time(double way, double speed) {
  return speed > 0.0 ? way / speed : 0.0;
}
/*# rpi_approach */
/* Velocity of the next period for a motion of a pose towards a goal that moves. The limits are linear and angular. */
static void rpi_approach(const double *from, const double *velocity, const double *to, const double *goal_velocity,
                         const double *most_velocity, const double *most_acceleration, double dt, double *out) {
  double q[4];
  double v[3];
  double way[6];
  double change[6];
  double size[2];
  double fast[2];
  double time;
  double share;
  int32_t k;
  rpi_inverse(from + 3, q);
  rpi_compose(q, to + 3, q);
  rpi_to_rotation_vector(q, v);
  rpi_rotate(from + 3, v, way + 3);
  rpi_difference(to, from, 3, way);
  time = rpi_greatest(rpi_travel_time(rpi_norm(way), most_velocity[0]),
                      rpi_travel_time(rpi_norm(way + 3), most_velocity[1]));
  rpi_add_scaled(way, goal_velocity, time, 6, way);
  size[0] = rpi_norm(way);
  size[1] = rpi_norm(way + 3);
  for (k = 0; k < 2; k += 1) {
    /* 80 % of the acceleration is planned with, as a margin against overshoot. */
    fast[k] = rpi_least(most_velocity[k], rpi_sqrt(2.0 * 0.8 * most_acceleration[k] * size[k]));
  }
  share = rpi_least(rpi_share_within(size[0], fast[0] * dt), rpi_share_within(size[1], fast[1] * dt)) / dt;
  rpi_scaled(way, share, 6, way);
  rpi_add_scaled(way, velocity, -1.0, 6, change);
  share = rpi_least(rpi_share_within(rpi_norm(change), most_acceleration[0] * dt),
                    rpi_share_within(rpi_norm(change + 3), most_acceleration[1] * dt));
  rpi_add_scaled(velocity, change, share, 6, out);
}
/*# rpi_otg */
/* One step of a time-optimal motion with bounded velocity and acceleration (Zanasi et al., 2000). */
static void rpi_otg(double position, double velocity, double goal, double goal_velocity, double most_velocity,
                    double most_acceleration, double dt, double *out_position, double *out_velocity,
                    double *out_acceleration) {
  double acceleration = 0.0;
  double next = velocity;
  if (most_acceleration != 0.0) {
    const double speed = (velocity - goal_velocity) / (most_acceleration * dt);
    const double z = (position - goal) / (most_acceleration * dt * dt) + speed / 2.0;
    const double m = rpi_floor((1.0 + rpi_sqrt(1.0 + 8.0 * rpi_abs(z))) / 2.0);
    const double sign = z > 0.0 ? 1.0 : (z < 0.0 ? -1.0 : 0.0);
    const double sigma = speed + z / m + (m - 1.0) / 2.0 * sign;
    const double room = most_velocity - most_acceleration * dt + velocity * (rpi_is_nan(sigma) ? 1.0 : rpi_copy_sign(1.0, sigma));
    acceleration = room < 0.0 ? 0.0 : -most_acceleration * rpi_bounded(sigma, -1.0, 1.0);
    next = velocity + acceleration * dt;
  }
  *out_position = position + next * dt;
  *out_velocity = next;
  *out_acceleration = acceleration;
}
/*# rpi_normal_angle */
/* Angle in the range -pi to pi. */
static double rpi_normal_angle(double angle) {
  return rpi_atan2(rpi_sin(angle), rpi_cos(angle));
}
/*# rpi_limited */
static inline double rpi_limited(double value, double bound) {
  return rpi_least(rpi_greatest(value, -bound), bound);
}
/*# rpi_drive */
/* Speed (m/s) and yaw rate (rad/s) of a differential drive towards a goal. */
static void rpi_drive(const double *position, const double *goal, double most_speed, double most_yaw, double gain,
                      double yaw_gain, double *speed, double *yaw) {
  double here[3];
  double there[3];
  double distance;
  double bearing;
  bool is_backwards;
  const double x = goal[0] - position[0];
  const double y = goal[1] - position[1];
  rpi_to_abc(position + 3, here);
  rpi_to_abc(goal + 3, there);
  distance = rpi_sqrt(x * x + y * y);
  *speed = 0.0;
  if (distance < 1e-3) {
    *yaw = rpi_limited(yaw_gain * rpi_normal_angle(there[0] - here[0]), most_yaw);
    return;
  }
  bearing = rpi_normal_angle(rpi_atan2(y, x) - here[0]);
  is_backwards = rpi_abs(bearing) > 1.57079632679489661923;
  if (is_backwards) {
    bearing = rpi_normal_angle(bearing + 3.14159265358979323846);
  }
  if (rpi_abs(bearing) > 0.1) {
    *yaw = rpi_limited(yaw_gain * bearing, most_yaw);
    return;
  }
  *yaw = 0.0;
  *speed = rpi_least(rpi_sqrt(2.0 * gain * distance), most_speed);
  if (is_backwards) {
    *speed = -*speed;
  }
}

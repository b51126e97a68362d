! SPDX-License-Identifier: MIT
!> Results of the published studies of the contact types, by which the program chooses a type: the
!> largest error estimate of each type in each kind of scene, and its contact time. Tests compare
!> the figures with the pages (doc/studies/choosing.md, speed_accuracy.md).
module type_charts_m
  use kinds_m, only : wp
  implicit none
  private
  public :: scene_bound, scene_matching, scene_general, scene_sliding, scene_friction, &
    scene_names, estimates, cheapest_type

  !> Kinds of scenes: type determined by other fields; flat matching meshes without sliding;
  !> general; prescribed sliding; friction.
  integer, parameter :: scene_bound = 0, scene_matching = 1, scene_general = 2, scene_sliding = 3, &
    scene_friction = 4

  !> Names of scenes 1 to 4 in messages.
  character(30), parameter :: scene_names(4) = [character(30) :: 'flat matching faces', &
    'non-matching or curved faces', 'prescribed sliding', 'friction']

  integer, parameter :: n_type = 7

  !> Largest error of each type in the patch test, and estimates for cylinder and spheres, sliding,
  !> and ironing.
  real(wp), parameter :: patch(n_type) = [0.71_wp, 0.50_wp, 0.72_wp, 0.0_wp, 0.0_wp, 0.046_wp, &
    0.0_wp]
  real(wp), parameter :: hertz(n_type) = [0.02573_wp, 0.02963_wp, 0.02342_wp, 0.0265_wp, &
    0.02371_wp, 0.0405_wp, 0.03132_wp]
  real(wp), parameter :: sliding(n_type) = [0.0403_wp, 0.0402_wp, 0.0971_wp, 0.0312_wp, &
    0.0406_wp, 0.0284_wp, 0.0285_wp]
  real(wp), parameter :: ironing(n_type) = [0.392_wp, 0.3548_wp, 0.1057_wp, 0.0918_wp, &
    0.1322_wp, 0.0884_wp, 0.0828_wp]
  !> Error estimate of each type in each kind of scene. All types are exact on matching faces.
  real(wp), parameter :: estimates(n_type, 4) = reshape([0.0_wp*patch, max(patch, hertz), &
    max(patch, sliding), max(patch, ironing)], [n_type, 4])

  !> Contact time of each type over the time of type 1.
  real(wp), parameter :: published_time(n_type) = [1.0_wp, 1.12_wp, 1.62_wp, 2.84_wp, 2.47_wp, &
    3.27_wp, 3.6_wp]

contains

  !> The cheapest type with an estimate of at most `bound`, or the type with the smallest estimate.
  !> On flat matching faces type 1 is excluded: type 2 weights the ends correctly.
  pure function cheapest_type(scene, bound) result(best)
    integer, intent(in) :: scene
    real(wp), intent(in) :: bound
    integer :: best
    real(wp) :: cost(n_type)

    cost = merge(published_time, huge(1.0_wp), estimates(:, scene) <= bound)
    if (scene == scene_matching) cost(1) = huge(1.0_wp)
    best = minloc(cost, 1)
    if (.not. any(estimates(:, scene) <= bound)) best = minloc(estimates(:, scene), 1)
  end function cheapest_type

end module type_charts_m

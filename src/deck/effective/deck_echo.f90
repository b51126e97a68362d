! SPDX-License-Identifier: MIT
!> Echo of the model in the log, and the effective deck: one file with parameters and command line
!> resolved, which gives the same model to the last bit. Unchanged lines are copied.
module deck_echo_m
  use kinds_m, only : wp
  use log_m, only : log_t, write_log, to_text
  use controls_m, only : interval_t
  use curves_m, only : curve_is_constant
  use deck_lines_m, only : deck_t, layout_marks
  use hardenings_m, only : hardening_t
  use history_tables_m, only : history_tables, n_table
  use model_m, only : model_t, is_sheet
  use parts_m, only : material_t
  use system_m, only : release_memory
  use walls_m, only : friction_sticks
  implicit none
  private
  public :: echo_model, write_effective

contains

  !> Write parts, materials, controls and conditions to the log (elements and interfaces are written
  !> by their layers).
  subroutine echo_model(model, path, log)
    type(model_t), intent(in) :: model
    character(*), intent(in) :: path
    type(log_t), intent(inout) :: log
    character(:), allocatable :: text
    integer :: n_element(size(model%parts))
    integer :: i

    n_element = 0
    do i = 1, model%mesh%n_element
      n_element(model%mesh%element_part(i)) = n_element(model%mesh%element_part(i)) + 1
    end do
    call write_log(log, 'deck: '//path)
    call write_log(log, 'title: '//model%controls%title)
    call write_log(log, 'mesh: '//to_text(model%mesh%n_node)//' nodes, ' &
      //to_text(model%mesh%n_element)//' elements, '//kind_of_bodies(model))
    if (model%is_axisymmetric) call write_log(log, 'axis: nodes at r = 0, ' &
      //'which are fixed in r: '//to_text(count(.not. model%mesh%coordinates(1, :) > 0.0_wp)) &
      //'; rigid bodies move along the axis only')
    do i = 1, size(model%parts)
      associate (part => model%parts(i))
        text = 'part '//to_text(part%id)//' "'//part%title//'": ' &
          //to_text(n_element(i))//' elements, section ' &
          //to_text(model%sections(part%section)%id)//', material ' &
          //to_text(model%materials(part%material)%id)
        if (model%sections(part%section)%is_plane_stress) text = text//', plane stress, ' &
          //'thickness '//to_text(model%sections(part%section)%thickness) &
          //trim(merge(' (follows its strain)', repeat(' ', 21), &
          model%materials(part%material)%follows_strain))
        call write_log(log, text)
      end associate
    end do
    do i = 1, size(model%materials)
      call echo_material(model, i, log)
    end do
    associate (conditions => model%conditions)
      call write_log(log, 'conditions: '//to_text(size(conditions%fixed_nodes)) &
        //' fixed and '//to_text(size(conditions%motions))//' prescribed degrees of freedom, ' &
        //to_text(size(conditions%nodal_loads))//' nodal loads, ' &
        //to_text(size(conditions%pressures))//' pressure edges, ' &
        //to_text(size(conditions%body_loads))//' body loads')
    end associate
    if (allocated(model%walls)) call echo_walls(model, log)
    if (allocated(model%stage%stresses)) call write_log(log, 'stresses of the stage before: ' &
      //to_text(model%stage%n_element)//' elements')
    call write_log(log, 'end time '//to_text(model%controls%end_time)//', time step factor ' &
      //to_text(model%controls%dt_scale))
    call echo_short_curves(model, log)
    if (model%controls%dt_curve > 0) call write_log(log, 'time step limited by curve ' &
      //to_text(model%curves(model%controls%dt_curve)%id))
    call echo_outputs(model, log)
  end subroutine echo_model

  !> What forces, masses and energies stand for.
  pure function kind_of_bodies(model) result(text)
    type(model_t), intent(in) :: model
    character(:), allocatable :: text

    text = 'plane strain, unit depth'
    if (model%is_axisymmetric) &
      text = 'axisymmetric about x = 0, forces, masses and energies per radian'
    if (is_sheet(model)) text = 'plane stress, forces, masses and energies of the thickness'
  end function kind_of_bodies

  !> Write the intervals of states, histories and restart files to the log.
  subroutine echo_outputs(model, log)
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log
    integer :: i

    call echo_interval('states', model%controls%output%plot)
    do i = 1, n_table
      call echo_interval(trim(history_tables(i)%name), model%controls%output%histories(i))
    end do
    if (any(model%controls%output%histories%is_binout)) call write_log(log, &
      "BINARY asks for binout: 'slideline-tools binout' writes it from the results")
    associate (plan => model%controls%output)
      if (plan%dump_cycles > 0) then
        call write_log(log, 'output restart files: every '//to_text(plan%dump_cycles) &
          //' cycles and at the end')
      else if (plan%dump_cycles == 0) then
        call write_log(log, 'output restart file: at the end')
      end if
      if (plan%running_cycles > 0) call write_log(log, 'output running restart file: every ' &
        //to_text(plan%running_cycles)//' cycles')
    end associate

  contains

    !> Write the interval of an output.
    subroutine echo_interval(name, interval)
      character(*), intent(in) :: name
      type(interval_t), intent(in) :: interval

      if (interval%curve > 0) then
        call write_log(log, 'output '//name//': interval by curve ' &
          //to_text(model%curves(interval%curve)%id))
      else if (interval%dt > 0.0_wp) then
        call write_log(log, 'output '//name//': every '//to_text(interval%dt))
      end if
    end subroutine echo_interval

  end subroutine echo_outputs

  !> Write the curves that end before the end time.
  subroutine echo_short_curves(model, log)
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log
    integer :: i

    do i = 1, size(model%curves)
      associate (curve => model%curves(i))
        if (curve_is_constant(curve) .or. .not. curve%is_of_time) cycle
        if (curve%abscissa(size(curve%abscissa)) >= model%controls%end_time) cycle
        call write_log(log, 'curve '//to_text(curve%id)//' ends at ' &
          //to_text(curve%abscissa(size(curve%abscissa)))//', before the end time; its last ' &
          //'value is used after it')
      end associate
    end do
  end subroutine echo_short_curves

  !> Write one material.
  subroutine echo_material(model, i, log)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    type(log_t), intent(inout) :: log
    character(:), allocatable :: text

    associate (material => model%materials(i))
      text = 'material '//to_text(material%id)//trim(merge(' in plane stress', '                ', &
        material%is_plane_stress))//': density '//to_text(material%density)//', E ' &
        //to_text(material%young)//', nu '//to_text(material%poisson)//', K ' &
        //to_text(material%bulk)//', G '//to_text(material%shear)//', c ' &
        //to_text(material%sound_speed)
      if (allocated(material%curve)) then
        text = text//hardening_text(material%curve)
      else if (material%yield > 0.0_wp) then
        text = text//', yield '//to_text(material%yield) &
        //', plastic modulus '//to_text(material%hardening)//', beta '//to_text(material%beta)
      end if
      text = text//impact_text(material)
    end associate
    call write_log(log, text)
  end subroutine echo_material

  !> Text of flow stress, equation of state, cut-off and failure.
  pure function impact_text(material) result(text)
    type(material_t), intent(in) :: material
    character(:), allocatable :: text

    text = ''
    if (allocated(material%flow)) text = text//', Johnson-Cook A '//to_text(material%flow%a) &
      //', B '//to_text(material%flow%b)//', n '//to_text(material%flow%n)//', C ' &
      //to_text(material%flow%c)//', rate '//to_text(material%flow%rate)
    if (allocated(material%flow)) then
      if (material%flow%heat > 0.0_wp) text = text//', adiabatic heating from ' &
        //to_text(material%flow%room)//', melting at '//to_text(material%flow%room &
        + material%flow%span)//', m '//to_text(material%flow%m)
      if (material%flow%has_damage) text = text//'; failed points (D = 1) have no deviatoric ' &
        //'stress and no tension'
    end if
    if (allocated(material%eos)) then
      if (material%eos%id > 0) text = text//', equation of state '//to_text(material%eos%id) &
        //' (initial K and c)'
    end if
    if (allocated(material%rubber)) then
      if (material%rubber%n_term > 0) then
        text = text//', Ogden rubber of '//to_text(material%rubber%n_term)//' term(s)'
      else
        text = text//', rubber A '//to_text(material%rubber%a)//', B ' &
          //to_text(material%rubber%b)
      end if
      text = text//' (moduli of small strain)'
    end if
    if (material%decay >= 0.0_wp) text = text//', viscoelastic, from this G to ' &
      //to_text(material%long_shear)//' with the decay constant '//to_text(material%decay)
    if (allocated(material%crush)) text = text//', crush curve ' &
      //to_text(material%crush%id)//', tensile cut-off '//to_text(material%tension)
    if (material%cutoff > -huge(1.0_wp)) text = text//', pressure cut-off ' &
      //to_text(material%cutoff)
    if (material%failure_strain < huge(1.0_wp)) text = text//', failure at plastic strain ' &
      //to_text(material%failure_strain)//' (zero stress after failure)'
    text = text//erosion_text(material)
  end function impact_text

  !> Text of the erosion criteria.
  pure function erosion_text(material) result(text)
    type(material_t), intent(in) :: material
    character(:), allocatable :: text

    text = ''
    if (.not. allocated(material%erosion)) then
      if (allocated(material%flow)) then
        if (material%flow%has_damage) text = '; failed elements do not erode'
      end if
      return
    end if
    associate (erosion => material%erosion)
      text = '; elements erode'
      if (erosion%by_law) text = text//' when all integration points have failed,'
      if (erosion%by_step) text = text//' below the smallest time step or without volume (ERODE),'
      if (erosion%n_given > 0) text = text//' where '//to_text(erosion%n_criteria)//' of ' &
        //to_text(erosion%n_given)//' criteria hold (points: '//to_text(erosion%n_point)//'),'
      if (erosion%least_step > 0.0_wp) text = text//' below the time step ' &
        //to_text(erosion%least_step)//','
      text = text(:len(text) - 1)
    end associate
  end function erosion_text

  !> Text of the hardening and its rate effect.
  pure function hardening_text(hardening) result(text)
    type(hardening_t), intent(in) :: hardening
    character(:), allocatable :: text
    integer :: n

    n = size(hardening%strain)
    text = ', yield '//to_text(hardening%stress(1, 1))//', hardening (points: ' &
      //to_text(n)//') up to plastic strain '//to_text(hardening%strain(n))//', then modulus ' &
      //to_text(hardening%slope(n, 1))
    if (size(hardening%rate) > 1) text = text//', '//to_text(size(hardening%rate)) &
      //' strain rates from '//to_text(hardening%rate(1))//' to '//to_text(maxval(hardening%rate))
    if (hardening%rate_constant > 0.0_wp) text = text//', Cowper-Symonds C ' &
      //to_text(hardening%rate_constant)//', P '//to_text(1.0_wp/hardening%rate_exponent)
    if (allocated(hardening%rate_factor)) text = text//', rate factor by curve ' &
      //to_text(hardening%rate_factor%id)
  end function hardening_text

  !> Write the rigid walls.
  subroutine echo_walls(model, log)
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log
    character(:), allocatable :: sliding, moving
    integer :: i

    do i = 1, size(model%walls)
      associate (wall => model%walls(i))
        sliding = 'without sliding'
        if (wall%friction < friction_sticks) sliding = 'with friction '//to_text(wall%friction)
        if (.not. wall%friction > 0.0_wp) sliding = 'without friction'
        moving = ''
        if (wall%mass > 0.0_wp) moving = ', moves with the mass '//to_text(wall%mass) &
          //' and at first the velocity '//to_text(wall%velocity)//' along its normal'
        call write_log(log, 'wall '//to_text(wall%id)//': through ('//to_text(wall%point(1))//', ' &
          //to_text(wall%point(2))//'), normal ('//to_text(wall%normal(1))//', ' &
          //to_text(wall%normal(2))//'), '//to_text(size(wall%nodes))//' nodes, plastic impact ' &
          //sliding//moving)
      end associate
    end do
  end subroutine echo_walls

  !> The text of the effective deck: its characters are counted, then written. Data for messages and
  !> the text of the files are deallocated as soon as possible.
  subroutine write_effective(deck, effective)
    type(deck_t), intent(inout) :: deck
    character(:), allocatable, intent(out) :: effective
    integer :: i, k, line, source, n, last_block(deck%n_source)

    if (allocated(deck%number)) deallocate (deck%number, deck%flags)
    call release_memory()
    do i = 1, deck%n_block
      last_block(deck%blocks(i)%source) = i
    end do
    do k = 1, 2
      if (k == 2) allocate (character(n) :: effective)
      n = 0
      call put('$ The deck as run: includes, parameters and command line resolved.')
      do i = 1, deck%parameters%n
        associate (item => deck%parameters%items(i))
          if (item%found) call put('$ parameter '//trim(item%name)//' = '//item%text)
        end associate
      end do
      call put('*KEYWORD')
      do i = 1, deck%n_block
        source = deck%blocks(i)%source
        if (.not. deck%blocks(i)%dropped) then
          call put('*'//deck%blocks(i)%given//trim(layout_marks(deck%blocks(i)%layout)))
          do line = deck%blocks(i)%first, deck%blocks(i)%last
            call put(deck%sources(merge(0, source, deck%first(line) < 0))%text( &
              abs(deck%first(line)):deck%last(line)))
          end do
        end if
        ! The text of a file is not needed after its last block.
        if (k == 2 .and. last_block(source) == i) deallocate (deck%sources(source)%text)
      end do
      call put('*END')
    end do

  contains

    !> Append a line.
    subroutine put(text)
      character(*), intent(in) :: text

      if (k == 2) effective(n + 1:n + len(text) + 1) = text//new_line('a')
      n = n + len(text) + 1
    end subroutine put

  end subroutine write_effective

end module deck_echo_m

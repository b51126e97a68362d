! SPDX-License-Identifier: MIT
!> Log of an interface.
module contact_log_m
  use contact_facets_m, only : coarse_turn
  use contact_dispatch_m, only : formulation_t, formulation_of, is_strict
  use contact_penalty_m, only : rigid_factor, mean_length, built_in_penalty, side_stiffness
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t, friction_rule_t, is_tied, breaks, kind_text, &
    penalty_share, penalty_implicit, penalty_per_node, penalty_distributed
  use law_state_m, only : is_held, is_broken
  use kinds_m, only : wp
  use log_m, only : log_t, write_log, warn, to_text, percent
  use model_m, only : model_t, is_sheet
  use surfaces_m, only : surface_t, has_closed_chain
  use ties_m, only : tied_nodes, tie_distance
  use units_m, only : units_t, in_units, per_depth
  implicit none
  private
  public :: log_contact, penalty_text, report_initial_contact, report_tie_step, report_end, &
    log_compliance

  !> Part of the search reach below which a penetration at time zero is round-off, that of
  !> coordinates written with some eight digits included.
  real(wp), parameter :: round_off = 1.0e-6_wp
  !> Share of the step of the elements below which the step with ties is worth a warning.
  real(wp), parameter :: dear_share = 0.5_wp
  !> Share of the built-in penalty, which is that of ten elements, below which a tie holds little.
  real(wp), parameter :: soft_tie = 0.1_wp
  !> Compliance of springs over that of elements above which a penalty in absolute units is far too
  !> soft: 200 times that of the default between like bodies.
  real(wp), parameter :: softest = 1000.0_wp
  !> Slave over master from where on implicit springs alternate: segments shorter by the one factor,
  !> elements stiffer by the other; and the factor on K L/A that softens it.
  real(wp), parameter :: finer = 0.75_wp, stiffer = 2.0_wp, soft_factor = 1.0_wp
  !> Nodes that a message names.
  integer, parameter :: most_named = 5

contains

  !> Log type, surfaces, all equivalents of the penalty, and the deepest first contact that is
  !> activated.
  subroutine log_contact(contact, model, memory, log)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(in) :: memory
    type(log_t), intent(inout) :: log
    character(:), allocatable :: title
    type(formulation_t) :: formulation

    formulation = formulation_of(contact)
    title = ''
    if (allocated(contact%title)) title = contact%title
    if (len(title) > 0) title = ' "'//title//'"'
    title = 'interface '//to_text(contact%id)//title//': '//kind_text(formulation%kind)
    if (contact%chosen_by_keyword) title = title//', chosen by keyword'
    if (allocated(contact%reason)) title = title//', chosen by the program (CTYPE 0): ' &
      //contact%reason
    if (contact%target > 0.0_wp) title = title//'; target of its error estimate ' &
      //to_text(contact%target)
    call write_log(log, title)
    if (contact%is_self) then
      call write_log(log, '  self contact: '//surface_text(contact%slave, model) &
        //', either side with '//to_text(formulation%self_share)//' of the penalty')
    else
      call write_log(log, '  slave: '//surface_text(contact%slave, model))
      call write_log(log, '  master: '//surface_text(contact%master, model))
    end if
    if (contact%penalty_unit == penalty_share) then
      call write_log(log, '  penalty: '//to_text(contact%penalty)//' of the largest stable one')
    else if (contact%penalty_unit == penalty_implicit) then
      call log_implicit(contact, model, memory%slave_penalty, log)
    else
      call write_log(log, '  penalty: '//penalty_text(contact, model, memory))
    end if
    if (formulation%kind%uses_gauss_points) call write_log(log, &
      '  Gauss points of a slave segment: '//to_text(contact%n_gauss))
    if (is_strict(contact)) then
      call write_log(log, '  strict rule where a slave segment hangs over the end of the master ' &
        //'(IPF = 1)')
    else if (formulation%kind%has_strict_rule) then
      call write_log(log, '  where a slave segment hangs over the end of the master, the master ' &
        //'nodes inside it count too and the rest carries nothing (default, IPF = 0)')
    end if
    if (memory%has%damping) call write_log(log, '  damping: ' &
      //to_text(contact%damping)//' of critical')
    if (memory%has%friction) call write_log(log, '  friction: ' &
      //friction_text(contact%friction, model%controls%units))
    if (memory%has%contact .and. contact%largest_turn > 0.0_wp) then
      call warn_of_coarse_circle(contact, contact%slave, 'slave', memory%positions, log)
      if (.not. contact%is_self) call warn_of_coarse_circle(contact, contact%master, 'master', &
        memory%positions(:, memory%n_slave + 1:), log)
    end if
    if (memory%has%arcs) then
      associate (is_curved => abs(memory%arcs%share(1, :)) > 0.0_wp, n => memory%n_slave)
        call write_log(log, '  arcs: '//to_text(count(is_curved(:n)))//' of ' &
          //to_text(contact%slave%n_segment)//' slave segments, ' &
          //to_text(count(is_curved(n + 1:)))//' of '//to_text(contact%master%n_segment) &
          //' master segments stand for arcs (SMOOTH)')
      end associate
    end if
    if (memory%has%ties) call log_ties(contact, model, memory, log)
    if (memory%has%contact) then
      call write_log(log, '  deepest first contact: '//to_text(minval( &
        memory%slave_status%point_depth))//in_units(model%controls%units, 'L')//' or less')
    end if
  end subroutine log_contact

  !> A warning where a circle is too coarse for arcs.
  subroutine warn_of_coarse_circle(contact, surface, side, positions, log)
    type(contact_t), intent(in) :: contact
    type(surface_t), intent(in) :: surface
    character(*), intent(in) :: side
    real(wp), intent(in) :: positions(:, :) !! (4, at least n_node) of the surface
    type(log_t), intent(inout) :: log
    real(wp) :: turn

    turn = coarse_turn(surface, positions, contact%largest_turn)*180.0_wp/acos(-1.0_wp)
    if (turn > 0.0_wp) call warn(log, 'interface '//to_text(contact%id)//': flat facets stand ' &
      //'for a circle of its '//side//' surface, whose segments turn by up to '//to_text(turn) &
      //' degrees, more than SMOOTH ('//to_text(nint(contact%largest_turn*180.0_wp &
      /acos(-1.0_wp)))//'): contact pressures are uneven there; set SMOOTH to ' &
      //to_text(ceiling(turn))//' for arcs, or -1 if facets are meant')
  end subroutine warn_of_coarse_circle

  !> Implicit springs, and a warning where the slave is both finer and stiffer: its nodes take turns
  !> then.
  subroutine log_implicit(contact, model, penalty, log)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: penalty !! N/m^2
    type(log_t), intent(inout) :: log
    real(wp) :: lengths(2), rows(2)

    if (penalty > 0.0_wp .and. contact%penalty < 0.0_wp) then
      call warn(log, 'interface '//to_text(contact%id)//': nodes of its slave are rigid, or held ' &
        //'before a rigid master, so that pressures without compliance may depend on each other: ' &
        //'implicit springs of ' &
        //to_text(rigid_factor)//' times K L/A of the softer side are taken')
    else if (penalty > 0.0_wp) then
      call write_log(log, '  penalty: implicit springs of '//to_text(penalty) &
        //in_units(model%controls%units, 'F/L^2')//', '//to_text(contact%penalty) &
        //' times K L/A of the softer side')
    else
      call write_log(log, '  penalty: implicit, without compliance')
    end if
    lengths = [mean_length(contact%slave, model), mean_length(contact%master, model)]
    ! K L^2/A: of square elements their bulk modulus.
    rows = lengths*[side_stiffness(contact%slave, model), side_stiffness(contact%master, model)]
    if (lengths(1) < finer*lengths(2) .and. rows(1) > stiffer*rows(2) &
      .and. .not. (penalty > 0.0_wp .and. contact%penalty <= soft_factor)) call warn(log, &
      'interface '//to_text(contact%id)//': its slave is both finer and stiffer than its master, ' &
      //'so that pressures may alternate from node to node; exchange the sides, or take a PEN of ' &
      //to_text(soft_factor)//' or less')
  end subroutine log_implicit

  !> `n nodes, m segments of mean length l m`.
  pure function surface_text(surface, model) result(text)
    type(surface_t), intent(in) :: surface
    type(model_t), intent(in) :: model
    character(:), allocatable :: text

    text = to_text(surface%n_node)//' nodes, '//to_text(surface%n_segment) &
      //' segments of mean length '//to_text(mean_length(surface, model)) &
      //in_units(model%controls%units, 'L')
  end function surface_text

  !> Log the extent of a tie, and warn of slave nodes without a master segment within the search
  !> radius where the surface is a node set; closed boundaries have far sides.
  subroutine log_ties(contact, model, memory, log)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(in) :: memory
    type(log_t), intent(inout) :: log
    character(:), allocatable :: names
    logical :: holds(memory%n_slave + memory%n_master)
    integer :: i, n

    if (memory%slave_penalty < soft_tie*built_in_penalty(contact, model)) call warn(log, &
      'interface '//to_text(contact%id)//': its ties are as soft as ' &
      //to_text(10.0_wp*built_in_penalty(contact, model)/memory%slave_penalty)//' elements of ' &
      //'its surfaces, so that tied surfaces separate under load; PEN 10 with PUNIT 2, the ' &
      //'default, is as stiff as one')
    holds = tied_nodes(memory, [is_held])
    n = size(memory%ties%side)
    call write_log(log, '  tied: '//to_text(count(holds(:memory%n_slave)))//' of ' &
      //to_text(memory%n_slave)//' slave nodes, '//to_text(n) &
      //' springs of area '//to_text(sum(memory%tie_points%area(:memory%tie_points%n))) &
      //', search radius '//to_text(tie_distance(contact, model)) &
      //in_units(model%controls%units, 'L'))
    if (breaks(contact)) call write_log(log, '  breaks at a tension of ' &
      //to_text(contact%strength(1))//' or a shear of '//to_text(contact%strength(2)) &
      //in_units(model%controls%units, 'F/L^2')//', together on an ellipse; sites that have ' &
      //'failed are in contact')
    if (memory%tie_points%n == 0 .or. all(holds(:memory%n_slave))) return
    if (has_closed_chain(contact%slave)) return
    n = 0
    names = ''
    do i = 1, memory%n_slave
      if (holds(i)) cycle
      n = n + 1
      if (n <= most_named) names = names//' '//to_text(model%mesh%node_id(memory%nodes(i)))
    end do
    if (n > most_named) names = names//' and '//to_text(n - most_named)//' more'
    call warn(log, 'interface '//to_text(contact%id)//': '//to_text(n)//' of ' &
      //to_text(memory%n_slave)//' slave nodes have no master segment within the search ' &
      //'radius (SRCH) and are not tied:'//names)
  end subroutine log_ties

  !> What ties cost: the stable step of the elements alone, and with the springs. A warning where
  !> they cost most of it: no run was meant to take so much longer.
  subroutine report_tie_step(id, element_limit, limit, log)
    integer, intent(in) :: id
    real(wp), intent(in) :: element_limit, limit !! s
    type(log_t), intent(inout) :: log
    character(:), allocatable :: text

    text = 'interface '//to_text(id)//': with its ties the stable step is '//to_text(limit) &
      //', of the elements alone '//to_text(element_limit)//': the ties cost ' &
      //percent(element_limit - limit, element_limit)//' of the step'
    if (limit < dear_share*element_limit) then
      call warn(log, text//'; a softer tie (PEN, SFACT) costs less')
    else
      call write_log(log, text)
    end if
  end subroutine report_tie_step

  !> Compliance of the springs over that of the elements at both surfaces (bulk modulus; rigid ones
  !> have none), and a warning of an absolute penalty that is far too soft.
  subroutine log_compliance(contact, model, memory, log, softness)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(in) :: memory
    type(log_t), intent(inout) :: log
    real(wp), intent(inout) :: softness !! that ratio; left alone between rigid bodies, and of ties
    type(formulation_t) :: formulation
    real(wp) :: stiffness !! of the springs of both passes, N/m^2
    real(wp) :: rows      !! compliance of the elements, m^2/N

    if (is_tied(contact)) return
    formulation = formulation_of(contact)
    stiffness = memory%slave_penalty
    if (formulation%has_two_passes) stiffness = stiffness + memory%master_penalty
    if (contact%is_self) stiffness = 2.0_wp*stiffness
    rows = row_compliance(contact%slave, model) + row_compliance(contact%master, model)
    if (.not. (stiffness > 0.0_wp .and. rows > 0.0_wp)) return
    softness = contact%thickness/(stiffness*rows)
    call write_log(log, 'interface '//to_text(contact%id)//': the compliance of ' &
      //'its springs is '//to_text(softness)//' times that of the elements at the surfaces (one ' &
      //'row on either side)')
    if (softness > softest .and. any(contact%penalty_unit == [penalty_per_node, &
      penalty_distributed])) call warn(log, 'interface '//to_text(contact%id)//': PEN ' &
      //to_text(contact%penalty)//' with PUNIT '//to_text(contact%penalty_unit)//' (0 where ' &
      //'blank) is '//to_text(softness)//' times as soft as the elements at the surfaces: bodies ' &
      //'penetrate each other; PEN 1 with PUNIT 2 is the built-in estimate')
  end subroutine log_compliance

  !> Compliance of the elements at a surface under a pressure: A/(K L), m^2/N.
  pure function row_compliance(surface, model) result(compliance)
    type(surface_t), intent(in) :: surface
    type(model_t), intent(in) :: model
    real(wp) :: compliance

    associate (part => model%mesh%element_part(surface%segment_element(1)))
      compliance = 0.0_wp
      if (.not. model%materials(model%parts(part)%material)%is_rigid) compliance = &
        1.0_wp/max(tiny(1.0_wp), side_stiffness(surface, model))
    end associate
  end function row_compliance

  !> The rule of friction.
  pure function friction_text(rule, units) result(text)
    type(friction_rule_t), intent(in) :: rule
    type(units_t), intent(in) :: units
    character(:), allocatable :: text

    text = 'coefficient '//to_text(rule%at_rest)
    if (rule%decay > 0.0_wp .and. abs(rule%at_rest - rule%sliding) > 0.0_wp) text = text &
      //' at rest, '//to_text(rule%sliding)//' in fast sliding, decay '//to_text(rule%decay) &
      //in_units(units, 'T/L')
    if (rule%most > 0.0_wp) text = text//', stress at most '//to_text(rule%most) &
      //in_units(units, 'F/L^2')
    text = text//'; tangential penalty '//to_text(rule%stiffness)//' of the normal one'
  end function friction_text

  !> All equivalents of the penalty, of the passes that the formulation has.
  function penalty_text(contact, model, memory) result(text)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(in) :: memory
    character(:), allocatable :: text
    character(:), allocatable :: factor, per_length !! PEN with PUNIT 2
    type(formulation_t) :: formulation
    real(wp) :: estimate

    per_length = in_units(model%controls%units, 'F/L^2')
    if (len(per_length) == 0) per_length = ' per unit length'
    text = to_text(memory%node_penalty)//in_units(model%controls%units, 'F/L') &
      //' per slave node = '//to_text(memory%slave_penalty)//per_length
    estimate = contact%thickness*built_in_penalty(contact, model)
    factor = to_text(memory%slave_penalty/estimate)
    formulation = formulation_of(contact)
    if (formulation%has_two_passes) then
      text = text//'; master pass ' &
        //to_text(memory%master_penalty*mean_length(contact%master, model)) &
        //in_units(model%controls%units, 'F/L')//' per master node = ' &
        //to_text(memory%master_penalty)//per_length
      factor = factor//' and '//to_text(memory%master_penalty/estimate)
    end if
    text = text//'; '//factor//' times the built-in estimate'
    if (model%is_axisymmetric) text = text &
      //' (per unit length of the circumference: times the radius, per radian)'
  end function penalty_text

  !> Warn of the deepest penetration at time zero, with the node next to it and the force that it
  !> causes; nothing when there is none. Initial penetrations are taken as they are.
  subroutine report_initial_contact(contact, model, memory, log)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(in) :: memory
    type(log_t), intent(inout) :: log
    character(:), allocatable :: text
    real(wp) :: depth !! that counts, m
    logical :: is_loaded(memory%points%n)
    integer :: p, k

    if (memory%points%n == 0 .and. allocated(contact%interference)) call warn(log, 'interface ' &
      //to_text(contact%id)//': its curve of interference (LCINT) has no effect: surfaces do not ' &
      //'overlap at time zero')
    if (memory%points%n == 0) return
    ! What ties hold has no force of contact.
    is_loaded = .true.
    if (memory%has%breaks) is_loaded = memory%points%pressure(:memory%points%n) > 0.0_wp
    if (.not. any(is_loaded)) return
    p = minloc(memory%points%gap(:memory%points%n), 1, is_loaded)
    depth = round_off*memory%slave_status%reach
    if (-memory%points%gap(p) <= depth) return
    k = maxloc(memory%points%slave_weights(:, p), 1)
    text = ' at '//to_text(count(is_loaded .and. memory%points%gap(:memory%points%n) < -depth)) &
      //' points, deepest at node '//to_text(model%mesh%node_id(memory%nodes( &
      memory%points%slave_nodes(k, p))))//': '//to_text(-memory%points%gap(p)) &
      //in_units(model%controls%units, 'L')
    if (allocated(contact%interference)) then
      call write_log(log, 'interface '//to_text(contact%id)//': interference'//text//'; curve ' &
        //to_text(contact%interference%id)//' (LCINT) applies it from 0 to the whole until ' &
        //to_text(contact%interference%abscissa(size(contact%interference%abscissa))) &
        //in_units(model%controls%units, 'T'))
      return
    end if
    if (.not. any(memory%points%pressure(:memory%points%n) > 0.0_wp)) then
      call warn(log, 'interface '//to_text(contact%id)//': initial penetration'//text &
        //', without force: the mean gap of the segment there is open')
      return
    end if
    call warn(log, 'interface '//to_text(contact%id)//': initial penetration'//text//', contact ' &
      //'force there '//to_text(memory%points%pressure(p)*memory%points%area(p)) &
      //per_depth(model%controls%units, 'F', model%is_axisymmetric, is_sheet(model)) &
      //'; the run starts with such forces; move the bodies apart, or apply the overlap by LCINT')
  end subroutine report_initial_contact

  !> Report at the end of the run failed ties and excluded first contacts.
  subroutine report_end(contact, units, memory, log)
    type(contact_t), intent(in) :: contact
    type(units_t), intent(in) :: units
    type(contact_state_t), intent(in) :: memory
    type(log_t), intent(inout) :: log
    character(:), allocatable :: name
    integer :: n

    name = 'interface '//to_text(contact%id)//': '
    n = memory%slave_status%n_released + memory%master_status%n_released
    if (n > 0) call warn(log, name//'first contacts deeper than the limit were excluded: ' &
      //to_text(n)//'; SRCH sets the limit')
    if (.not. breaks(contact)) return
    n = count(memory%ties%state == is_broken)
    if (n == 0) then
      call write_log(log, name//'no tie failed')
    else
      call write_log(log, name//to_text(n)//' of ' &
        //to_text(count(memory%ties%state == is_held) + n)//' tie points failed, from time ' &
        //to_text(memory%ties%first_break)//' to '//to_text(memory%ties%last_break) &
        //'; their stored energy, '//to_text(memory%ties%spent) &
        //per_depth(units, 'F L', contact%is_axisymmetric, contact%is_sheet) &
        //', stays in the energy of contact')
    end if
  end subroutine report_end

end module contact_log_m

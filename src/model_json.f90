! SPDX-License-Identifier: MIT
!> The model of a deck as JSON, for programs that draw or check it: nodes, elements, parts, sets,
!> conditions, walls and interfaces as understood, by user ids and in deck order. Lists of one kind
!> are columns of the same length.
module model_json_m
  use kinds_m, only : wp
  use contact_dispatch_m, only : formulation_t, formulation_of
  use contacts_m, only : contact_t, is_tied, kind_text, n_told
  use deck_findings_m, only : json_text
  use log_m, only : to_text
  use material_dispatch_m, only : law_name
  use model_m, only : model_t
  use surfaces_m, only : surface_t
  use number_text_m, only : shortest
  use text_m, only : text_of
  implicit none
  private
  public :: model_json

  !> A growing text.
  type :: buffer_t
    character(:), allocatable :: text
    integer :: n = 0                  !! characters so far
    logical :: is_first = .true.      !! of the members of an object: no comma before it
  end type buffer_t

  character(1), parameter :: new = new_line('a')

contains

  !> The model as one JSON object. Before its nodes are renumbered: they are in deck order.
  function model_json(model) result(text)
    type(model_t), intent(in) :: model
    character(:), allocatable :: text
    type(buffer_t) :: buffer

    allocate (character(65536) :: buffer%text)
    call put(buffer, '{'//new)
    call put_member(buffer, 'title', json_text(text_of(model%controls%title)))
    call put_member(buffer, 'axisymmetric', truth(model%is_round))
    call put_mesh(model, buffer)
    call put_parts(model, buffer)
    call put_sets(model, buffer)
    call put_curves(model, buffer)
    call put_supports(model, buffer)
    call put_motions(model, buffer)
    call put_loads(model, buffer)
    call put_bodies(model, buffer)
    call put_walls(model, buffer)
    call put_interfaces(model, buffer)
    call put(buffer, new//'  }')
    text = buffer%text(:buffer%n)
  end function model_json

  !> Nodes, elements and the velocities at the start.
  subroutine put_mesh(model, buffer)
    type(model_t), intent(in) :: model
    type(buffer_t), intent(inout) :: buffer

    associate (mesh => model%mesh)
      call put_member(buffer, 'node_ids', integers(mesh%node_id))
      call put_member(buffer, 'x', reals(mesh%coordinates(1, :)))
      call put_member(buffer, 'y', reals(mesh%coordinates(2, :)))
      call put_member(buffer, 'element_ids', integers(mesh%element_id))
      call put_member(buffer, 'element_parts', integers([model%parts(mesh%element_part)%id]))
      call put_member(buffer, 'element_nodes', &
        integers([mesh%node_id(reshape(mesh%element_nodes, [4*mesh%n_element]))]))
      call put_member(buffer, 'history_nodes', &
        integers([mesh%node_id(model%controls%output%history_nodes)]))
    end associate
    if (.not. allocated(model%conditions%initial_velocity)) return
    call put_member(buffer, 'velocity_x', reals(model%conditions%initial_velocity(1, :)))
    call put_member(buffer, 'velocity_y', reals(model%conditions%initial_velocity(2, :)))
  end subroutine put_mesh

  !> Parts with what they are made of.
  subroutine put_parts(model, buffer)
    type(model_t), intent(in) :: model
    type(buffer_t), intent(inout) :: buffer
    type(buffer_t) :: list
    integer :: i

    do i = 1, size(model%parts)
      associate (part => model%parts(i), material => model%materials(model%parts(i)%material))
        call put_entry(list, '"id": '//to_text(part%id)//', "title": '//json_text(part%title) &
          //', "section": '//to_text(model%sections(part%section)%id)//', "material": ' &
          //to_text(material%id)//', "law": '//json_text(law_name(material))//', "density": ' &
          //shortest(material%density)//', "young": '//shortest(material%young) &
          //', "poisson": '//shortest(material%poisson))
      end associate
    end do
    call put_list(buffer, 'parts', list)
  end subroutine put_parts

  !> Sets of nodes, parts and segments.
  subroutine put_sets(model, buffer)
    type(model_t), intent(in) :: model
    type(buffer_t), intent(inout) :: buffer
    type(buffer_t) :: nodes, parts, segments
    integer :: i

    do i = 1, size(model%node_sets)
      associate (set => model%node_sets(i))
        call put_entry(nodes, '"id": '//to_text(set%id)//', "title": ' &
          //json_text(text_of(set%title))//', "nodes": '//integers([model%mesh%node_id(set%nodes)]))
      end associate
    end do
    do i = 1, size(model%part_sets)
      associate (set => model%part_sets(i))
        call put_entry(parts, '"id": '//to_text(set%id)//', "parts": ' &
          //integers([model%parts(set%parts)%id]))
      end associate
    end do
    do i = 1, size(model%segment_sets)
      associate (set => model%segment_sets(i))
        call put_entry(segments, '"id": '//to_text(set%id)//', "nodes": ' &
          //integers([model%mesh%node_id(reshape(set%nodes, [size(set%nodes)]))]))
      end associate
    end do
    call put_list(buffer, 'node_sets', nodes)
    call put_list(buffer, 'part_sets', parts)
    call put_list(buffer, 'segment_sets', segments)
  end subroutine put_sets

  !> Curves with their factors and offsets applied.
  subroutine put_curves(model, buffer)
    type(model_t), intent(in) :: model
    type(buffer_t), intent(inout) :: buffer
    type(buffer_t) :: list
    integer :: i

    do i = 1, size(model%curves)
      associate (curve => model%curves(i))
        call put_entry(list, '"id": '//to_text(curve%id)//', "x": '//reals(curve%abscissa) &
          //', "y": '//reals(curve%ordinate))
      end associate
    end do
    call put_list(buffer, 'curves', list)
  end subroutine put_curves

  !> What holds nodes, and what makes them heavier.
  subroutine put_supports(model, buffer)
    type(model_t), intent(in) :: model
    type(buffer_t), intent(inout) :: buffer
    type(buffer_t) :: columns
    integer :: i

    associate (conditions => model%conditions, id => model%mesh%node_id)
      call put_column(columns, 'node', integers([id(conditions%fixed_nodes)]))
      call put_column(columns, 'direction', integers(conditions%fixed_directions))
      call put_columns(buffer, 'fixed', columns)
      if (allocated(conditions%skew_supports)) then
        associate (supports => conditions%skew_supports)
          call put_column(columns, 'node', integers([id(supports%node)]))
          call put_column(columns, 'x', reals([(supports(i)%normal(1), i=1, size(supports))]))
          call put_column(columns, 'y', reals([(supports(i)%normal(2), i=1, size(supports))]))
        end associate
        call put_columns(buffer, 'skew_supports', columns)
      end if
      if (allocated(conditions%lumped_masses)) then
        call put_column(columns, 'node', integers([id(conditions%lumped_masses%node)]))
        call put_column(columns, 'mass', reals([conditions%lumped_masses%mass]))
        call put_columns(buffer, 'lumped_masses', columns)
      end if
      if (.not. allocated(conditions%common_motions)) return
      do i = 1, size(conditions%common_motions)
        associate (motion => conditions%common_motions(i))
          call put_entry(columns, '"nodes": '//integers([id(motion%nodes)])//', "x": ' &
            //truth(motion%along(1))//', "y": '//truth(motion%along(2)))
        end associate
      end do
      call put_list(buffer, 'common_motions', columns)
    end associate
  end subroutine put_supports

  !> Prescribed motions of nodes and bodies.
  subroutine put_motions(model, buffer)
    type(model_t), intent(in) :: model
    type(buffer_t), intent(inout) :: buffer
    type(buffer_t) :: columns

    associate (motions => model%conditions%motions)
      call put_column(columns, 'node', integers([model%mesh%node_id(motions%node)]))
      call put_column(columns, 'direction', integers([motions%direction]))
      call put_column(columns, 'kind', integers([motions%kind]))
      call put_column(columns, 'curve', integers([model%curves(motions%curve)%id]))
      call put_column(columns, 'scale', reals([motions%scale]))
      call put_columns(buffer, 'motions', columns)
    end associate
    if (.not. allocated(model%conditions%rigid_motions)) return
    associate (motions => model%conditions%rigid_motions)
      call put_column(columns, 'part', &
        integers([model%parts(model%rigids(motions%node)%part)%id]))
      call put_column(columns, 'direction', integers([motions%direction]))
      call put_column(columns, 'kind', integers([motions%kind]))
      call put_column(columns, 'curve', integers([model%curves(motions%curve)%id]))
      call put_column(columns, 'scale', reals([motions%scale]))
      call put_columns(buffer, 'body_motions', columns)
    end associate
  end subroutine put_motions

  !> Loads on nodes, edges and bodies.
  subroutine put_loads(model, buffer)
    type(model_t), intent(in) :: model
    type(buffer_t), intent(inout) :: buffer
    type(buffer_t) :: columns
    integer :: i

    associate (conditions => model%conditions, id => model%mesh%node_id, curve => model%curves%id)
      associate (loads => conditions%nodal_loads)
        call put_column(columns, 'node', integers([id(loads%node)]))
        call put_column(columns, 'direction', integers([loads%direction]))
        call put_column(columns, 'curve', integers([curve(loads%curve)]))
        call put_column(columns, 'scale', reals([loads%scale]))
        call put_columns(buffer, 'nodal_loads', columns)
      end associate
      associate (loads => conditions%pressures)
        call put_column(columns, 'first', integers([(id(loads(i)%nodes(1)), i=1, size(loads))]))
        call put_column(columns, 'second', integers([(id(loads(i)%nodes(2)), i=1, size(loads))]))
        call put_column(columns, 'curve', integers([curve(loads%curve)]))
        call put_column(columns, 'scale', reals([loads%scale]))
        call put_columns(buffer, 'pressures', columns)
      end associate
      associate (loads => conditions%body_loads)
        call put_column(columns, 'direction', integers([loads%direction]))
        call put_column(columns, 'curve', integers([curve(loads%curve)]))
        call put_column(columns, 'scale', reals([loads%scale]))
        call put_columns(buffer, 'body_loads', columns)
      end associate
      if (.not. allocated(conditions%rigid_loads)) return
      associate (loads => conditions%rigid_loads)
        call put_column(columns, 'part', &
          integers([model%parts(model%rigids(loads%node)%part)%id]))
        call put_column(columns, 'direction', integers([loads%direction]))
        call put_column(columns, 'curve', integers([curve(loads%curve)]))
        call put_column(columns, 'scale', reals([loads%scale]))
        call put_columns(buffer, 'rigid_loads', columns)
      end associate
    end associate
  end subroutine put_loads

  !> Rigid bodies: what they may not do, and their velocities where the deck gives them their own.
  subroutine put_bodies(model, buffer)
    type(model_t), intent(in) :: model
    type(buffer_t), intent(inout) :: buffer
    type(buffer_t) :: list
    integer :: i
    character(:), allocatable :: velocity

    do i = 1, size(model%rigids)
      associate (body => model%rigids(i))
        velocity = ''
        if (body%has_velocity) velocity = ', "velocity": '//reals(body%velocity)
        call put_entry(list, '"part": '//to_text(model%parts(body%part)%id)//', "held_x": ' &
          //truth(body%is_fixed(1))//', "held_y": '//truth(body%is_fixed(2))//', "held_turn": ' &
          //truth(body%is_fixed(3))//velocity)
      end associate
    end do
    call put_list(buffer, 'rigid_bodies', list)
  end subroutine put_bodies

  !> Rigid walls.
  subroutine put_walls(model, buffer)
    type(model_t), intent(in) :: model
    type(buffer_t), intent(inout) :: buffer
    type(buffer_t) :: list
    integer :: i

    if (.not. allocated(model%walls)) return
    do i = 1, size(model%walls)
      associate (wall => model%walls(i))
        call put_entry(list, '"id": '//to_text(wall%id)//', "point": '//reals(wall%foot) &
          //', "normal": '//reals(wall%normal)//', "friction": '//shortest(wall%friction) &
          //', "nodes": '//to_text(size(wall%nodes)))
      end associate
    end do
    call put_list(buffer, 'walls', list)
  end subroutine put_walls

  !> Interfaces with their surfaces in walking direction, as pairs of nodes.
  subroutine put_interfaces(model, buffer)
    type(model_t), intent(in) :: model
    type(buffer_t), intent(inout) :: buffer
    type(buffer_t) :: list
    integer :: i

    do i = 1, n_told(model%contacts)
      associate (contact => model%contacts(i))
        call put_entry(list, '"id": '//to_text(contact%id)//', "title": ' &
          //json_text(text_of(contact%title))//', "type": '//to_text(contact%contact_type) &
          //', "formulation": '//json_text(formulation_text(contact))//', "friction": ' &
          //shortest(contact%friction%at_rest)//', "sliding_friction": ' &
          //shortest(contact%friction%sliding)//', "tied": '//truth(is_tied(contact)) &
          //', "self": '//truth(contact%is_self)//', "slave": '//segments(contact%slave) &
          //', "master": '//segments(contact%master))
      end associate
    end do
    call put_list(buffer, 'interfaces', list)

  contains

    !> A surface as pairs of nodes.
    function segments(surface) result(text)
      type(surface_t), intent(in) :: surface
      character(:), allocatable :: text

      text = integers(model%mesh%node_id(surface%nodes(reshape(surface%segments, &
        [2*surface%n_segment]))))
    end function segments

  end subroutine put_interfaces

  !> Name and number of the type of an interface.
  function formulation_text(contact) result(text)
    type(contact_t), intent(in) :: contact
    character(:), allocatable :: text
    type(formulation_t) :: formulation

    formulation = formulation_of(contact)
    text = kind_text(formulation%kind)
  end function formulation_text

  ! ---- JSON -------------------------------------------------------------------------------------

  !> Append to a text.
  subroutine put(buffer, text)
    type(buffer_t), intent(inout) :: buffer
    character(*), intent(in) :: text
    character(:), allocatable :: longer

    if (.not. allocated(buffer%text)) allocate (character(4096) :: buffer%text)
    if (buffer%n + len(text) > len(buffer%text)) then
      allocate (character(2*(buffer%n + len(text))) :: longer)
      longer(:buffer%n) = buffer%text(:buffer%n)
      call move_alloc(longer, buffer%text)
    end if
    buffer%text(buffer%n + 1:buffer%n + len(text)) = text
    buffer%n = buffer%n + len(text)
  end subroutine put

  !> One member of the model.
  subroutine put_member(buffer, name, value)
    type(buffer_t), intent(inout) :: buffer
    character(*), intent(in) :: name, value

    if (.not. buffer%is_first) call put(buffer, ','//new)
    buffer%is_first = .false.
    call put(buffer, '    "'//name//'": '//value)
  end subroutine put_member

  !> One object of a list.
  subroutine put_entry(list, members)
    type(buffer_t), intent(inout) :: list
    character(*), intent(in) :: members

    if (list%n > 0) call put(list, ','//new)
    call put(list, '      {'//members//'}')
  end subroutine put_entry

  !> A list as a member; it is empty then.
  subroutine put_list(buffer, name, list)
    type(buffer_t), intent(inout) :: buffer, list
    character(*), intent(in) :: name

    if (list%n == 0) then
      call put_member(buffer, name, '[]')
    else
      call put_member(buffer, name, '['//new//list%text(:list%n)//new//'    ]')
    end if
    list%n = 0
  end subroutine put_list

  !> One column of a table.
  subroutine put_column(columns, name, values)
    type(buffer_t), intent(inout) :: columns
    character(*), intent(in) :: name, values

    if (columns%n > 0) call put(columns, ', ')
    call put(columns, '"'//name//'": '//values)
  end subroutine put_column

  !> A table as a member; it is empty then.
  subroutine put_columns(buffer, name, columns)
    type(buffer_t), intent(inout) :: buffer, columns
    character(*), intent(in) :: name

    call put_member(buffer, name, '{'//columns%text(:columns%n)//'}')
    columns%n = 0
  end subroutine put_columns

  !> An array of whole numbers. What comes from arrays of types stands in brackets where it is
  !> handed over: the compiler would make a temporary for it by itself.
  function integers(values) result(text)
    integer, intent(in) :: values(:)
    character(:), allocatable :: text
    type(buffer_t) :: buffer
    integer :: i

    call put(buffer, '[')
    do i = 1, size(values)
      if (i > 1) call put(buffer, ', ')
      call put(buffer, to_text(values(i)))
    end do
    call put(buffer, ']')
    text = buffer%text(:buffer%n)
  end function integers

  !> An array of reals that read back as they are.
  function reals(values) result(text)
    real(wp), intent(in) :: values(:)
    character(:), allocatable :: text
    type(buffer_t) :: buffer
    integer :: i

    call put(buffer, '[')
    do i = 1, size(values)
      if (i > 1) call put(buffer, ', ')
      call put(buffer, shortest(values(i)))
    end do
    call put(buffer, ']')
    text = buffer%text(:buffer%n)
  end function reals

  !> A logical value.
  pure function truth(value) result(text)
    logical, intent(in) :: value
    character(:), allocatable :: text

    text = trim(merge('true ', 'false', value))
  end function truth

end module model_json_m

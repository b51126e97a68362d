! SPDX-License-Identifier: MIT
!> Writes the model to the file of the state at time zero, for plots: tables in the group /model
!> with one dataset for each column, by user ids and in deck order. Empty tables are omitted; a
!> column of texts is one text with a line for each row.
module model_tables_m
  use archive_m, only : archive_t
  use conditions_m, only : prescribed_motion_t, nodal_load_t
  use contact_dispatch_m, only : formulation_t, formulation_of
  use contacts_m, only : kind_text
  use errors_m, only : error_t
  use hdf5_writing_m, only : hid_t, make_group, write_text
  use kinds_m, only : wp
  use material_dispatch_m, only : law_name
  use model_m, only : model_t
  use results_arrays_m, only : utf8_text
  use text_m, only : text_of
  implicit none
  private
  public :: write_model

  !> The table in progress.
  type, extends(archive_t) :: table_t
  contains
    procedure :: open => open_table
    procedure :: put_integers, put_reals, put_text
    generic :: put => put_integers, put_reals, put_text
  end type table_t

  character(1), parameter :: new = new_line('a')

contains

  !> Write all tables.
  subroutine write_model(id, model, error)
    integer(hid_t), intent(in) :: id                   !! open file
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(inout) :: error !! nothing is written where allocated
    type(table_t) :: table

    if (allocated(error)) return
    table%id = id
    call make_group(id, 'model', table%error)
    call write_parts(table, model)
    call write_supports(table, model)
    call write_loads(table, model)
    call write_interfaces(table, model)
    call move_alloc(table%error, error)
  end subroutine write_model

  !> Create a table unless it is empty.
  subroutine open_table(table, name, n_row)
    class(table_t), intent(inout) :: table
    character(*), intent(in) :: name
    integer, intent(in) :: n_row

    table%folder = 'model/'//name//'/'
    if (n_row > 0) call make_group(table%id, 'model/'//name, table%error)
  end subroutine open_table

  !> Write a column of integers. Components of derived types are passed in brackets, since the
  !> compiler would make a temporary anyway.
  subroutine put_integers(table, name, values)
    class(table_t), intent(inout) :: table
    character(*), intent(in) :: name
    integer, intent(in) :: values(:)
    integer, allocatable :: copy(:)

    allocate (copy, source=values)
    if (size(copy) > 0) call table%visit(name, copy)
  end subroutine put_integers

  !> Write a column of reals.
  subroutine put_reals(table, name, values)
    class(table_t), intent(inout) :: table
    character(*), intent(in) :: name
    real(wp), intent(in) :: values(:)
    real(wp), allocatable :: copy(:)

    allocate (copy, source=values)
    if (size(copy) > 0) call table%visit(name, copy)
  end subroutine put_reals

  !> Write a column of texts with line ends.
  subroutine put_text(table, name, lines)
    class(table_t), intent(inout) :: table
    character(*), intent(in) :: name, lines

    call write_text(table%id, table%folder//name, utf8_text(lines), table%error)
  end subroutine put_text

  !> Write title and kind of the model, parts, node sets and curves.
  subroutine write_parts(table, model)
    type(table_t), intent(inout) :: table
    type(model_t), intent(in) :: model
    character(:), allocatable :: titles, laws, of_sets
    integer :: i, k

    titles = ''
    laws = ''
    do i = 1, size(model%parts)
      titles = titles//text_of(model%parts(i)%title)//new
      laws = laws//law_name(model%materials(model%parts(i)%material))//new
    end do
    of_sets = ''
    do i = 1, size(model%node_sets)
      of_sets = of_sets//text_of(model%node_sets(i)%title)//new
    end do
    call table%open('deck', 1)
    call table%put('title', text_of(model%controls%title)//new)
    call table%put('axisymmetric', [merge(1, 0, model%is_axisymmetric)])
    associate (parts => model%parts, materials => model%materials, sets => model%node_sets, &
      curves => model%curves, n => size(model%parts))
      call table%open('parts', n)
      call table%put('id', [parts%id])
      call table%put('title', titles)
      call table%put('section', [model%sections(parts%section)%id])
      call table%put('material', [(materials(parts(i)%material)%id, i=1, n)])
      call table%put('law', laws)
      call table%put('density', [(materials(parts(i)%material)%density, i=1, n)])
      call table%put('young', [(materials(parts(i)%material)%young, i=1, n)])
      call table%put('poisson', [(materials(parts(i)%material)%poisson, i=1, n)])
      call table%open('node_sets', size(sets))
      call table%put('id', [sets%id])
      call table%put('title', of_sets)
      call table%put('n_node', [(size(sets(i)%nodes), i=1, size(sets))])
      call table%put('node', [(model%mesh%node_id(sets(i)%nodes), i=1, size(sets))])
      call table%open('curves', size(curves))
      call table%put('curve', [((curves(i)%id, k=1, size(curves(i)%abscissa)), i=1, size(curves))])
      call table%put('x', [(curves(i)%abscissa, i=1, size(curves))])
      call table%put('y', [(curves(i)%ordinate, i=1, size(curves))])
    end associate
    call table%open('history_nodes', size(model%controls%output%history_nodes))
    call table%put('node', [model%mesh%node_id(model%controls%output%history_nodes)])
  end subroutine write_parts

  !> Write constraints of nodes and rigid bodies, lumped masses and rigid walls.
  subroutine write_supports(table, model)
    type(table_t), intent(inout) :: table
    type(model_t), intent(in) :: model
    integer :: i

    associate (conditions => model%conditions, id => model%mesh%node_id, rigids => model%rigids)
      call table%open('fixed', size(conditions%fixed_nodes))
      call table%put('node', [id(conditions%fixed_nodes)])
      call table%put('direction', conditions%fixed_directions)
      call table%open('rigid_bodies', size(rigids))
      call table%put('part', [model%parts(rigids%part)%id])
      call table%put('held_x', [(merge(1, 0, rigids(i)%is_fixed(1)), i=1, size(rigids))])
      call table%put('held_y', [(merge(1, 0, rigids(i)%is_fixed(2)), i=1, size(rigids))])
      call table%put('held_turn', [(merge(1, 0, rigids(i)%is_fixed(3)), i=1, size(rigids))])
      if (allocated(conditions%skew_supports)) then
        call table%open('skew_supports', size(conditions%skew_supports))
        call table%put('node', [id(conditions%skew_supports%node)])
      end if
      if (allocated(conditions%lumped_masses)) then
        call table%open('lumped_masses', size(conditions%lumped_masses))
        call table%put('node', [id(conditions%lumped_masses%node)])
      end if
      if (allocated(conditions%common_motions)) then
        call table%open('common_motions', size(conditions%common_motions))
        call table%put('node', [(id(conditions%common_motions(i)%nodes), i=1, &
          size(conditions%common_motions))])
      end if
    end associate
    if (.not. allocated(model%walls)) return
    associate (walls => model%walls)
      call table%open('walls', size(walls))
      call table%put('id', [walls%id])
      call table%put('x', [(walls(i)%point(1), i=1, size(walls))])
      call table%put('y', [(walls(i)%point(2), i=1, size(walls))])
      call table%put('normal_x', [(walls(i)%normal(1), i=1, size(walls))])
      call table%put('normal_y', [(walls(i)%normal(2), i=1, size(walls))])
      call table%put('friction', [walls%friction])
    end associate
  end subroutine write_supports

  !> Write prescribed motions and loads of nodes, edges and rigid bodies.
  subroutine write_loads(table, model)
    type(table_t), intent(inout) :: table
    type(model_t), intent(in) :: model
    integer, allocatable :: bodies(:)
    integer :: i

    bodies = [model%parts(model%rigids%part)%id]
    associate (id => model%mesh%node_id, conditions => model%conditions)
      call put_motions('motions', 'node', id, conditions%motions)
      call put_motions('body_motions', 'part', bodies, conditions%rigid_motions)
      call put_loads('nodal_loads', 'node', id, conditions%nodal_loads)
      call put_loads('rigid_loads', 'part', bodies, conditions%rigid_loads)
      associate (loads => conditions%pressures)
        call table%open('pressures', size(loads))
        call table%put('first', [(id(loads(i)%nodes(1)), i=1, size(loads))])
        call table%put('second', [(id(loads(i)%nodes(2)), i=1, size(loads))])
        call put_scale([loads%curve], [loads%scale])
      end associate
      associate (loads => conditions%body_loads)
        call table%open('body_loads', size(loads))
        call table%put('direction', [loads%direction])
        call put_scale([loads%curve], [loads%scale])
      end associate
    end associate

  contains

    !> Write motions of nodes or rigid bodies, unless absent.
    subroutine put_motions(name, column, ids, motions)
      character(*), intent(in) :: name, column
      integer, intent(in) :: ids(:)  !! of nodes or parts
      type(prescribed_motion_t), intent(in), optional :: motions(:)

      if (.not. present(motions)) return
      call table%open(name, size(motions))
      call table%put(column, [ids(motions%node)])
      call table%put('direction', [motions%direction])
      call table%put('kind', [motions%kind])
      call put_scale([motions%curve], [motions%scale])
    end subroutine put_motions

    !> Write loads on nodes or rigid bodies, unless absent.
    subroutine put_loads(name, column, ids, loads)
      character(*), intent(in) :: name, column
      integer, intent(in) :: ids(:)
      type(nodal_load_t), intent(in), optional :: loads(:)

      if (.not. present(loads)) return
      call table%open(name, size(loads))
      call table%put(column, [ids(loads%node)])
      call table%put('direction', [loads%direction])
      call put_scale([loads%curve], [loads%scale])
    end subroutine put_loads

    !> Write curves and their scale factors.
    subroutine put_scale(curves, factors)
      integer, intent(in) :: curves(:)
      real(wp), intent(in) :: factors(:)

      call table%put('curve', [model%curves(curves)%id])
      call table%put('scale', factors)
    end subroutine put_scale

  end subroutine write_loads

  !> Write interfaces, and the nodes of their segments in walking order, slave before master.
  subroutine write_interfaces(table, model)
    type(table_t), intent(inout) :: table
    type(model_t), intent(in) :: model
    character(:), allocatable :: titles, formulations
    integer, allocatable :: nodes(:)
    type(formulation_t) :: formulation
    integer :: i, n

    n = size(model%contacts)
    titles = ''
    formulations = ''
    nodes = [integer ::]
    do i = 1, n
      associate (contact => model%contacts(i), slave => model%contacts(i)%slave, &
        master => model%contacts(i)%master)
        formulation = formulation_of(contact)
        titles = titles//text_of(contact%title)//new
        formulations = formulations//kind_text(formulation%kind)//new
        nodes = [nodes, slave%nodes(reshape(slave%segments, [2*slave%n_segment])), &
          master%nodes(reshape(master%segments, [2*master%n_segment]))]
      end associate
    end do
    associate (contacts => model%contacts)
      call table%open('interfaces', n)
      call table%put('id', [contacts%id])
      call table%put('title', titles)
      call table%put('type', [contacts%contact_type])
      call table%put('formulation', formulations)
      call table%put('friction', [contacts%friction%at_rest])
      call table%put('sliding_friction', [contacts%friction%sliding])
      call table%put('n_slave', [contacts%slave%n_segment])
      call table%put('n_master', [contacts%master%n_segment])
      call table%put('node', [model%mesh%node_id(nodes)])
    end associate
  end subroutine write_interfaces

end module model_tables_m
